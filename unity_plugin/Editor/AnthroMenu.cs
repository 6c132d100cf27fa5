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
            var character = made.AddComponent<AnthroCharacter>();
            Undo.RegisterCreatedObjectUndo(made, "Create AnthroNet Character");
            // Unity calls Awake in the editor only for components that ask for it.
            if (character.Body == null)
            {
                character.Generate();
            }
            Selection.activeObject = made;
        }
    }

    /// <summary>Frees the shared model before the code is loaded anew; finalisers free the rest.</summary>
    [InitializeOnLoad]
    static class AnthroReload
    {
        static AnthroReload()
        {
            AssemblyReloadEvents.beforeAssemblyReload += AnthroModel.ReleaseDefault;
        }
    }
}
