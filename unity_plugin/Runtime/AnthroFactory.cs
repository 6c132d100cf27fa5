using System;
using System.Collections;
using System.Collections.Generic;
using System.Diagnostics;
using System.Linq;
using UnityEngine;

namespace Anthronet
{
    /// <summary>What characters that the factory makes are like.</summary>
    public sealed class AnthroSettings
    {
        /// <summary>The finest level of detail, 0 to 3.</summary>
        public int finestLod = 1;
        /// <summary>The coarsest level of detail, 0 to 3.</summary>
        public int coarsestLod = 3;
        /// <summary>Step of the Monk scale, 1 to 10; 0 for the default.</summary>
        public int skinTone;
        /// <summary>Whether they get a humanoid avatar.</summary>
        public bool humanoid = true;
        /// <summary>Where they go; null for the scene's root.</summary>
        public Transform parent;
        /// <summary>The model that makes them; null for the library's own.</summary>
        public AnthroModel model;
        /// <summary>Where characters are taken from, and the new ones' settings then are its; null for none.</summary>
        public AnthroPool pool;
    }

    /// <summary>Makes characters from code.</summary>
    public static class AnthroFactory
    {
        /// <summary>Makes a character, at once. On the main thread.</summary>
        /// <exception cref="AnthroException">The request is refused; the scene stays as it was.</exception>
        public static AnthroCharacter Create(AnthroRequest request, AnthroSettings settings = null)
        {
            settings = settings ?? new AnthroSettings();
            var body = (settings.model ?? AnthroModel.Default).Generate(request);
            var character = Blank(request, settings);
            character.Become(body);
            return character;
        }

        /// <summary>
        /// Makes characters: their bodies on threads of the library, then the objects on the main thread in slices. Something
        /// has to call `AnthroSpawn.Advance` each frame: `AnthroRunner.Run` does.
        /// </summary>
        public static AnthroSpawn CreateAsync(IList<AnthroRequest> requests, AnthroSettings settings = null)
        {
            settings = settings ?? new AnthroSettings();
            var copies = new AnthroRequest[requests.Count];
            for (var i = 0; i < copies.Length; i++)
            {
                copies[i] = requests[i].Copy();
            }
            return new AnthroSpawn(copies, settings);
        }

        internal static AnthroCharacter Blank(AnthroRequest request, AnthroSettings settings)
        {
            var pooled = settings.pool == null ? null : settings.pool.Take();
            if (pooled != null)
            {
                pooled.transform.SetParent(settings.parent, false);
                pooled.Request = request.Copy();
                return pooled;
            }
            var made = new GameObject("AnthroNet Character");
            // Asleep until it is whole: it is told not to generate itself.
            made.SetActive(false);
            made.transform.SetParent(settings.parent, false);
            var character = made.AddComponent<AnthroCharacter>();
            character.GenerateOnAwake = false;
            character.Request = request.Copy();
            character.FinestLod = settings.finestLod;
            character.CoarsestLod = settings.coarsestLod;
            character.SkinTone = settings.skinTone;
            character.Humanoid = settings.humanoid;
            made.SetActive(true);
            return character;
        }
    }

    /// <summary>Characters that are being made.</summary>
    public sealed class AnthroSpawn : IDisposable
    {
        readonly AnthroJob[] jobs;
        readonly AnthroRequest[] requests;
        readonly AnthroSettings settings;
        readonly AnthroCharacter[] characters;
        readonly AnthroException[] errors;
        readonly Stopwatch watch = new Stopwatch();
        int next;
        IEnumerator steps;
        bool freed;

        internal AnthroSpawn(AnthroRequest[] requests, AnthroSettings settings)
        {
            // A job makes one body after the other: two, taken from in turns, keep more cores busy.
            var model = settings.model ?? AnthroModel.Default;
            jobs = new AnthroJob[2];
            try
            {
                for (var i = 0; i < jobs.Length; i++)
                {
                    jobs[i] = model.Start(requests.Where((request, place) => place % jobs.Length == i).ToArray());
                }
            }
            catch
            {
                Dispose();
                throw;
            }
            this.requests = requests;
            this.settings = settings;
            characters = new AnthroCharacter[requests.Length];
            errors = new AnthroException[requests.Length];
        }

        /// <summary>Called for every character that is whole, with its place.</summary>
        public event Action<int, AnthroCharacter> OnSpawned;

        /// <summary>Number of requests.</summary>
        public int Count
        {
            get { return requests.Length; }
        }

        /// <summary>How many have their character or error.</summary>
        public int Done
        {
            get { return next; }
        }

        /// <summary>Whether all have, or it was disposed of.</summary>
        public bool IsDone
        {
            get { return freed || next == requests.Length; }
        }

        /// <summary>A character, null before it is whole or where it failed.</summary>
        public AnthroCharacter Character(int index)
        {
            return index < next ? characters[index] : null;
        }

        /// <summary>Why there is no character; null where there is one or will be.</summary>
        public AnthroException Error(int index)
        {
            return errors[index];
        }

        /// <summary>
        /// Goes on for about so many milliseconds, on the main thread: a step that has begun is ended, and at least one is
        /// done where there is something to do.
        /// </summary>
        /// <returns>Whether all is done.</returns>
        public bool Advance(double milliseconds)
        {
            watch.Restart();
            while (!IsDone)
            {
                if (steps == null)
                {
                    AnthroBody body;
                    if (!jobs[next % jobs.Length].TryTake(next / jobs.Length, out body, out errors[next]))
                    {
                        if (errors[next] == null)
                        {
                            return false;
                        }
                        next++;
                        continue;
                    }
                    characters[next] = AnthroFactory.Blank(requests[next], settings);
                    steps = characters[next].BecomeInSteps(body);
                }
                if (!steps.MoveNext())
                {
                    steps = null;
                    next++;
                    if (OnSpawned != null)
                    {
                        OnSpawned(next - 1, characters[next - 1]);
                    }
                }
                if (watch.Elapsed.TotalMilliseconds >= milliseconds)
                {
                    break;
                }
            }
            return IsDone;
        }

        /// <summary>Asks for no more characters: those that are whole stay, the others get the error `Cancelled`.</summary>
        public void Cancel()
        {
            foreach (var job in jobs)
            {
                job.Cancel();
            }
        }

        /// <summary>Cancels it and frees the job. Characters that are whole stay, one that is not is destroyed.</summary>
        public void Dispose()
        {
            foreach (var job in jobs)
            {
                if (job != null)
                {
                    job.Dispose();
                }
            }
            freed = true;
            if (steps != null)
            {
                UnityEngine.Object.Destroy(characters[next].gameObject);
                steps = null;
            }
        }
    }
}
