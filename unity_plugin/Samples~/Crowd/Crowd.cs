using Anthronet;
using UnityEngine;

/// 200 different people in rows, spawned within a budget of time per frame, walking on the spot.
public sealed class Crowd : MonoBehaviour
{
    public int count = 200;
    public float distance = 1.2f;
    public double millisecondsPerFrame = 4.0;

    AnthroSpawn spawn;

    void Start()
    {
        var requests = new AnthroRequest[count];
        for (var i = 0; i < count; i++)
        {
            requests[i] = new AnthroRequest
            {
                Sex = i % 2 == 0 ? AnthroSex.Female : AnthroSex.Male,
                Seed = (ulong)(i + 1),
                Fill = AnthroFill.Sample,
            };
        }
        AnthroRunner.Budget = millisecondsPerFrame;
        spawn = AnthroFactory.CreateAsync(requests, new AnthroSettings { finestLod = 1, parent = transform });
        spawn.OnSpawned += Place;
        AnthroRunner.Run(spawn);
    }

    void Place(int index, AnthroCharacter character)
    {
        character.transform.localPosition = Position(index, count, distance);
        var animator = character.gameObject.AddComponent<AnthroAnimator>();
        animator.Play("walk");
        animator.Time = 0.37 * index;
    }

    /// Rows of a square around the middle.
    public static Vector3 Position(int index, int count, float distance)
    {
        var side = 1;
        while (side * side < count)
        {
            side++;
        }
        return new Vector3((index % side - 0.5f * (side - 1)) * distance, 0f, (index / side - 0.5f * (side - 1)) * distance);
    }

    void OnDestroy()
    {
        if (spawn != null)
        {
            spawn.Dispose();
        }
    }
}
