using UnityEngine;

namespace Anthronet
{
    /// <summary>Destroying objects in play mode and in edit mode.</summary>
    internal static class AnthroObjects
    {
        /// <summary>Destroys an object with the function for the current mode. GameObjects of a prefab instance, which
        /// Unity does not allow to destroy, are deactivated instead.</summary>
        public static void DestroySafely(Object one)
        {
            if (one == null)
            {
                return;
            }
            if (Application.isPlaying)
            {
                Object.Destroy(one);
                return;
            }
#if UNITY_EDITOR
            var child = one as GameObject;
            if (child != null && UnityEditor.PrefabUtility.IsPartOfPrefabInstance(child)
                && !UnityEditor.PrefabUtility.IsAddedGameObjectOverride(child))
            {
                child.SetActive(false);
                return;
            }
#endif
            Object.DestroyImmediate(one);
        }
    }
}
