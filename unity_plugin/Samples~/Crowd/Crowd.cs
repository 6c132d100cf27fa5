using UnityEngine;

namespace Anthronet.Samples
{
    /// <summary>
    /// The people of a population file in rows, spawned within a budget of time per frame, walking on the spot. Assign
    /// `population.jsonl.txt`, which lies beside this, or a file of your own.
    /// </summary>
    public sealed class Crowd : MonoBehaviour
    {
        /// <summary>A request a line; without it people are drawn by their seeds alone.</summary>
        public TextAsset population;
        /// <summary>Most people; those of the file or this many without.</summary>
        public int count = 200;
        /// <summary>Metres from one to the next.</summary>
        public float distance = 1.2f;
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

        /// <summary>At most so many requests, of a population where there is one.</summary>
        public static AnthroRequest[] Requests(string population, int most)
        {
            if (population != null)
            {
                var read = AnthroPopulation.Read(population);
                System.Array.Resize(ref read, Mathf.Min(read.Length, most));
                return read;
            }
            var drawn = new AnthroRequest[most];
            for (var i = 0; i < most; i++)
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
            character.transform.localPosition = Position(index, spawn.Count, distance);
            // One that was used before has an animator already.
            var animator = character.GetComponent<AnthroAnimator>();
            if (animator == null)
            {
                animator = character.gameObject.AddComponent<AnthroAnimator>();
            }
            animator.Play("walk");
            animator.Time = 0.37 * index;
        }

        /// <summary>Rows of a square around the middle.</summary>
        public static Vector3 Position(int index, int count, float distance)
        {
            var side = 1;
            while (side * side < count)
            {
                side++;
            }
            return new Vector3(
                (index % side - 0.5f * (side - 1)) * distance, 0f, (index / side - 0.5f * (side - 1)) * distance);
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
