using UnityEngine;

namespace Anthronet.Samples
{
    /// <summary>
    /// The people of a population file, spawned in a grid within a time budget per frame, walking in place. Assign the
    /// sample's `population.jsonl.txt` or a file of your own.
    /// </summary>
    public sealed class Crowd : MonoBehaviour
    {
        [Tooltip("One request per line; without a file, people are random.")]
        public TextAsset population;
        [Tooltip("Number of people, at most as many as the file has.")]
        public int count = 200;
        [Tooltip("Distance between neighbours, metres.")]
        public float spacing = 1.2f;
        [Tooltip("Time budget per frame for spawning, milliseconds.")]
        public double millisecondsPerFrame = 4.0;

        AnthroSpawn spawn;

        void Start()
        {
            var requests = Requests(population == null ? null : population.text, count);
            AnthroRunner.Budget = millisecondsPerFrame;
            spawn = AnthroFactory.CreateAsync(requests, new AnthroSettings { finestLod = 1, parent = transform });
            spawn.OnSpawned += Place;
            AnthroRunner.Run(spawn);
        }

        /// <summary>The first requests of a population, or random ones without a population.</summary>
        public static AnthroRequest[] Requests(string population, int maxCount)
        {
            if (population != null)
            {
                var read = AnthroPopulation.Read(population);
                System.Array.Resize(ref read, Mathf.Min(read.Length, maxCount));
                return read;
            }
            var drawn = new AnthroRequest[maxCount];
            for (var i = 0; i < maxCount; i++)
            {
                drawn[i] = new AnthroRequest
                {
                    Sex = i % 2 == 0 ? AnthroSex.Female : AnthroSex.Male,
                    Seed = (ulong)(i + 1),
                    Fill = AnthroFill.Sample,
                };
            }
            return drawn;
        }

        void Place(int index, AnthroCharacter character)
        {
            character.transform.localPosition = Position(index, spawn.Count, spacing);
            // A pooled character has an animator already.
            var animator = character.GetComponent<AnthroAnimator>();
            if (animator == null)
            {
                animator = character.gameObject.AddComponent<AnthroAnimator>();
            }
            animator.Play("walk");
            animator.Time = 0.37 * index;
        }

        /// <summary>Position in a square grid around the origin.</summary>
        public static Vector3 Position(int index, int count, float spacing)
        {
            var side = 1;
            while (side * side < count)
            {
                side++;
            }
            return new Vector3(
                (index % side - 0.5f * (side - 1)) * spacing, 0f, (index / side - 0.5f * (side - 1)) * spacing);
        }

        void OnDestroy()
        {
            if (spawn != null)
            {
                spawn.Dispose();
            }
        }
    }
}
