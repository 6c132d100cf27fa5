// Stand-ins for Unity's editor: events, assets, prefabs. See ../signatures.txt.
using System;
using System.Collections.Generic;
using System.Linq;
using UnityEngine;
using Object = UnityEngine.Object;

namespace UnityEditor
{
    public enum PlayModeStateChange
    {
        EnteredEditMode = 0,
        ExitingEditMode = 1,
        EnteredPlayMode = 2,
        ExitingPlayMode = 3,
    }

    public sealed class EditorApplication
    {
        public delegate void CallbackFunction();
        public static CallbackFunction update;
        public static event Action<PlayModeStateChange> playModeStateChanged;
        internal static void Raise(PlayModeStateChange change) { playModeStateChanged(change); }
    }

    public static class EditorUtility
    {
        internal static readonly List<string> Dialogs = new List<string>();
        internal static readonly List<Object> Dirty = new List<Object>();
        public static bool DisplayDialog(string title, string message, string ok) { Dialogs.Add(message); return true; }
        public static void SetDirty(Object target) { Dirty.Add(target); }
        public static string SaveFilePanelInProject(string title, string defaultName, string extension, string message)
        {
            return User.Ask(title, "");
        }
    }

    public class Undo
    {
        internal static readonly List<string> Steps = new List<string>();
        public static void RecordObject(Object objectToUndo, string name) { Steps.Add(name); }
        public static void RegisterCreatedObjectUndo(Object objectToUndo, string name) { Steps.Add(name); }
    }

    public static class Selection
    {
        public static Object activeObject { get; set; }
    }

    public static class GameObjectUtility
    {
        public static void SetParentAndAlign(GameObject child, GameObject parent)
        {
            child.transform.SetParent(parent == null ? null : parent.transform, false);
        }
    }

    public sealed class MenuCommand
    {
        public MenuCommand(Object inContext) { context = inContext; }
        public Object context;
    }

    public static class AssemblyReloadEvents
    {
        public delegate void AssemblyReloadCallback();
        public static event AssemblyReloadCallback beforeAssemblyReload;
        internal static void Raise() { beforeAssemblyReload(); }
    }

    [AttributeUsage(AttributeTargets.Class)]
    public class CustomEditor : Attribute
    {
        public CustomEditor(Type inspectedType) { }
    }

    [AttributeUsage(AttributeTargets.Class)]
    public class InitializeOnLoadAttribute : Attribute { }

    [AttributeUsage(AttributeTargets.Method)]
    public sealed class MenuItem : Attribute
    {
        public MenuItem(string itemName, bool isValidateFunction, int priority) { }
    }

    public class AssetDatabase
    {
        /// The project's files with their objects, the main object first.
        internal static readonly Dictionary<string, List<Object>> Files = new Dictionary<string, List<Object>>();

        public static void CreateAsset(Object asset, string path)
        {
            Store(asset);
            Files[path] = new List<Object> { asset };
        }

        public static void AddObjectToAsset(Object objectToAdd, Object assetObject)
        {
            Store(objectToAdd);
            Files.Values.Single(file => file.Contains(assetObject)).Add(objectToAdd);
        }

        static void Store(Object asset)
        {
            if ((asset.hideFlags & HideFlags.DontSave) != 0 || asset.Asset)
            {
                throw new ArgumentException("not to be saved, or saved already: " + asset.name);
            }
            asset.Asset = true;
        }

        public static bool Contains(Object obj) { return obj.Asset; }
        public static void SaveAssets() { }

        public static bool DeleteAsset(string path)
        {
            if (!Files.ContainsKey(path))
            {
                return false;
            }
            foreach (var part in Files[path])
            {
                part.Asset = false;
                Object.DestroyImmediate(part);
            }
            return Files.Remove(path);
        }
    }

    public static class PrefabUtility
    {
        internal static bool Fails;
        internal static readonly Dictionary<string, GameObject> Prefabs = new Dictionary<string, GameObject>();

        /// Refuses what Unity would drop or lose.
        public static GameObject SaveAsPrefabAsset(GameObject instanceRoot, string assetPath, out bool success)
        {
            success = !Fails;
            if (Fails)
            {
                return null;
            }
            var playing = Application.Playing;
            Application.Playing = false;
            var prefab = Cloning.Of(instanceRoot);
            Application.Playing = playing;
            Check(prefab.transform);
            Prefabs[assetPath] = prefab;
            return prefab;
        }

        static void Check(Transform at)
        {
            var drawn = at.GetComponent<SkinnedMeshRenderer>();
            if ((at.gameObject.hideFlags & HideFlags.DontSave) != 0 || at.gameObject.parts.Exists(part => (part.hideFlags & HideFlags.DontSave) != 0))
            {
                throw new InvalidOperationException(at.name + " would not be saved");
            }
            if (drawn != null && (!drawn.sharedMesh.Asset || drawn.sharedMaterials.Any(material => !material.Asset)))
            {
                throw new InvalidOperationException(at.name + " wears what is no asset");
            }
            foreach (var child in at.children)
            {
                Check(child);
            }
        }

        public static bool IsPartOfPrefabInstance(Object componentOrGameObject) { return componentOrGameObject.OfPrefab; }
        public static bool IsAddedGameObjectOverride(GameObject gameObject) { return !gameObject.OfPrefab; }
        public static void RecordPrefabInstancePropertyModifications(Object targetObject) { }
    }

    public struct EditorCurveBinding
    {
        public string path;
        public string propertyName;
        public Type type { get; set; }

        public static EditorCurveBinding FloatCurve(string inPath, Type inType, string inPropertyName)
        {
            return new EditorCurveBinding { path = inPath, type = inType, propertyName = inPropertyName };
        }
    }

    public class AnimationClipSettings
    {
        public bool loopTime;
    }

    public class AnimationUtility
    {
        public static void SetEditorCurve(AnimationClip clip, EditorCurveBinding binding, AnimationCurve curve)
        {
            clip.Set(binding.path, binding.type, binding.propertyName, curve);
        }

        public static AnimationClipSettings GetAnimationClipSettings(AnimationClip clip)
        {
            return new AnimationClipSettings { loopTime = clip.Loops };
        }

        public static void SetAnimationClipSettings(AnimationClip clip, AnimationClipSettings srcClipInfo)
        {
            clip.Loops = srcClipInfo.loopTime;
        }
    }
}
