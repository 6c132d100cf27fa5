using System.Collections.Generic;
using UnityEngine;

namespace Anthronet
{
    /// <summary>
    /// Inactive characters for reuse: GameObjects, skeletons and meshes are kept. All characters of a pool should have
    /// the same levels of detail. Main thread only.
    /// </summary>
    public sealed class AnthroPool
    {
        readonly Stack<AnthroCharacter> free = new Stack<AnthroCharacter>();

        /// <summary>Number of inactive characters in the pool.</summary>
        public int Count
        {
            get { return free.Count; }
        }

        /// <summary>Returns a character to the pool: deactivates it, stops its clip and removes event handlers.</summary>
        public void Release(AnthroCharacter character)
        {
            if (character == null || free.Contains(character))
            {
                return;
            }
            var animator = character.GetComponent<AnthroAnimator>();
            if (animator != null)
            {
                animator.Play((AnthroClip)null);
            }
            character.gameObject.SetActive(false);
            character.ClearListeners();
            free.Push(character);
        }

        /// <summary>Takes a character from the pool; null if the pool is empty. It is inactive and still has its previous
        /// body: give it a new one before you activate it.</summary>
        public AnthroCharacter Get()
        {
            while (free.Count > 0)
            {
                var character = free.Pop();
                // It may have been destroyed with its scene.
                if (character != null)
                {
                    return character;
                }
            }
            return null;
        }

        /// <summary>Destroys all characters in the pool.</summary>
        public void Clear()
        {
            while (free.Count > 0)
            {
                var character = free.Pop();
                if (character != null)
                {
                    AnthroObjects.DestroySafely(character.gameObject);
                }
            }
        }
    }
}
