using UnityEngine;

namespace Anthronet
{
    /// <summary>A component that works on the character of its GameObject and follows every change of its body.</summary>
    [RequireComponent(typeof(AnthroCharacter))]
    public abstract class AnthroCharacterBehaviour : MonoBehaviour
    {
        AnthroCharacter character;

        internal AnthroCharacterBehaviour()
        {
        }

        /// <summary>The character of the GameObject.</summary>
        public AnthroCharacter Character
        {
            get
            {
                if (character == null)
                {
                    character = GetComponent<AnthroCharacter>();
                }
                return character;
            }
        }

        /// <summary>The body of the character.</summary>
        /// <exception cref="System.InvalidOperationException">The character is not generated.</exception>
        internal AnthroBody RequireBody()
        {
            if (Character.Body == null)
            {
                throw new System.InvalidOperationException("the character is not generated yet: " + gameObject.name);
            }
            return Character.Body;
        }

        /// <summary>Called when the character has a new body, and when the component is enabled on one that has a
        /// body.</summary>
        internal abstract void OnBody(AnthroBody body);

        /// <summary>Unity's message.</summary>
        protected void OnEnable()
        {
            Character.OnGenerated += OnBody;
            if (Character.Body != null)
            {
                OnBody(Character.Body);
            }
        }

        /// <summary>Unity's message.</summary>
        protected void OnDisable()
        {
            if (Character != null)
            {
                Character.OnGenerated -= OnBody;
            }
        }
    }
}
