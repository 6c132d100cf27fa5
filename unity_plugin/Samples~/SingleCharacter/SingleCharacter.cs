using Anthronet;
using UnityEngine;

/// One person, walking; height and waist may be changed while it plays.
public sealed class SingleCharacter : MonoBehaviour
{
    [Range(1.4f, 2.0f)] public float height = 1.72f;
    [Range(0.6f, 1.3f)] public float waist = 0.82f;

    AnthroCharacter character;
    AnthroAnimator animator;
    float shownHeight, shownWaist;

    void Start()
    {
        character = AnthroFactory.Create(Request(), new AnthroSettings { finestLod = 0, parent = transform });
        character.OnReport += body => Debug.Log(body.Sex + ", " + body.Mass.ToString("0.0") + " kg");
        animator = character.gameObject.AddComponent<AnthroAnimator>();
        animator.Play("walk");
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
            character.Generate();
            // A clip is made for a body: its hips are as high as the legs are long.
            animator.Play("walk");
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
