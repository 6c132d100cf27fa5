using Anthronet.Native;
using UnityEditor;
using UnityEngine;

namespace Anthronet.Editor
{
    /// <summary>What the package adds to the editor's menus.</summary>
    public static class AnthroMenu
    {
        /// <summary>Makes a character in the scene.</summary>
        [MenuItem("GameObject/3D Object/AnthroNet Character", false, 10)]
        public static void Create(MenuCommand command)
        {
            var made = new GameObject("AnthroNet Character");
            GameObjectUtility.SetParentAndAlign(made, command.context as GameObject);
            // It generates itself when it is added, and tells in the console where it cannot.
            made.AddComponent<AnthroCharacter>();
            Undo.RegisterCreatedObjectUndo(made, "Create AnthroNet Character");
            Selection.activeObject = made;
        }
    }

    /// <summary>
    /// Releases what is native before the code is loaded anew: threads, memory, materials. Characters and animators make
    /// it again when Unity enables them.
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
