using Anthronet.Native;
using UnityEditor;
using UnityEngine;

namespace Anthronet.Editor
{
    /// <summary>Menu entries.</summary>
    public static class AnthroMenu
    {
        /// <summary>Adds a character to the scene.</summary>
        [MenuItem("GameObject/3D Object/AnthroNet Character", false, 10)]
        public static void Create(MenuCommand command)
        {
            var made = new GameObject("AnthroNet Character");
            GameObjectUtility.SetParentAndAlign(made, command.context as GameObject);
            // The new component generates the character itself, and logs an error if it cannot.
            made.AddComponent<AnthroCharacter>();
            Undo.RegisterCreatedObjectUndo(made, "Create AnthroNet Character");
            Selection.activeObject = made;
        }
    }

    /// <summary>
    /// Releases native memory, threads and materials before a domain reload. Characters and animators recreate theirs
    /// when Unity enables them.
    /// </summary>
    [InitializeOnLoad]
    internal static class AnthroReload
    {
        static AnthroReload()
        {
            AssemblyReloadEvents.beforeAssemblyReload += Release;
            EditorApplication.playModeStateChanged += change =>
            {
                if (change == PlayModeStateChange.ExitingPlayMode || change == PlayModeStateChange.ExitingEditMode)
                {
                    AnthroRunner.ReleaseAll();
                }
            };
        }

        internal static void Release()
        {
            AnthroRunner.ReleaseAll();
            AnthroAlive.ReleaseAll();
            AnthroModel.ReleaseDefault();
            AnthroMaterials.Release();
        }
    }
}
