using UnityEngine;

namespace Anthronet.Samples
{
    /// <summary>One walking character whose height and waist can be changed while it plays.</summary>
    public sealed class SingleCharacter : MonoBehaviour
    {
        [Tooltip("Height, metres.")] [Range(1.4f, 2.0f)] public float height = 1.72f;
        [Tooltip("Waist circumference, metres.")] [Range(0.6f, 1.3f)] public float waist = 0.82f;

        AnthroCharacter character;
        float shownHeight, shownWaist;

        void Start()
        {
            character = AnthroFactory.Create(Request(), new AnthroSettings { finestLod = 0, parent = transform });
            character.OnGenerated += body => Debug.Log(body.Sex + ", " + body.Mass.ToString("0.0") + " kg");
            character.gameObject.AddComponent<AnthroAnimator>().Play("walk");
        }

        void Update()
        {
            if (height == shownHeight && waist == shownWaist)
            {
                return;
            }
            character.Request = Request();
            try
            {
                // It walks on: the built-in clip is retargeted to the longer or shorter legs.
                character.Generate();
            }
            catch (AnthroException error)
            {
                Debug.LogException(error);
            }
        }

        AnthroRequest Request()
        {
            shownHeight = height;
            shownWaist = waist;
            return new AnthroRequest { Nearest = true, Seed = 1 }
                .Set("height", height).Set("waist_circumference", waist);
        }
    }
}
