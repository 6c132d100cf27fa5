using UnityEngine;

namespace Anthronet
{
    /// <summary>Destroying of what the package made.</summary>
    internal static class AnthroObjects
    {
        /// <summary>Destroys an object as the mode wants it. What belongs to an instance of a prefab, which Unity lets
        /// nobody destroy, is put to sleep instead.</summary>
        public static void Discard(Object one)
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
