using System.Collections.Generic;
using UnityEngine;

namespace Anthronet
{
    /// <summary>
    /// Characters that are not needed now, to become others later: objects, skeletons and meshes are used again. All of one
    /// pool should have the same levels of detail. On the main thread alone.
    /// </summary>
    public sealed class AnthroPool
    {
        readonly Stack<AnthroCharacter> free = new Stack<AnthroCharacter>();

        /// <summary>Number of characters in it.</summary>
        public int Count
        {
            get { return free.Count; }
        }

        /// <summary>Puts a character to sleep, to be used again: its clip ends and nobody hears of its reports any longer.
        /// </summary>
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
            character.Forget();
            free.Push(character);
        }

        /// <summary>A character, asleep and still who it was: let it become another before you wake it. Null where there is
        /// none.</summary>
        public AnthroCharacter Take()
        {
            while (free.Count > 0)
            {
                var character = free.Pop();
                // Destroyed with its scene meanwhile.
                if (character != null)
                {
                    return character;
                }
            }
            return null;
        }

        /// <summary>Destroys all that are in it.</summary>
        public void Clear()
        {
            while (free.Count > 0)
            {
                var character = free.Pop();
                if (character != null)
                {
                    AnthroObjects.Discard(character.gameObject);
                }
            }
        }
    }
}
