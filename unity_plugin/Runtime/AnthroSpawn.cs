using System;
using System.Collections;
using System.Diagnostics;
using System.Linq;
using System.Threading;
using Anthronet.Native;

namespace Anthronet
{
    /// <summary>
    /// Characters being made asynchronously. Jobs of the library generate bodies, one thread per job packs mesh data, and
    /// `Advance` makes the GameObjects on the main thread.
    /// </summary>
    public sealed class AnthroSpawn : IDisposable
    {
        readonly AnthroRequest[] requests;
        readonly AnthroSettings settings;
        readonly AnthroJob[] jobs;
        readonly Thread[] packers;
        readonly AnthroBuild[] builds;
        readonly AnthroException[] errors;
        readonly AnthroCharacter[] characters;
        readonly Stopwatch watch = new Stopwatch();
        // Guards `builds`, `errors`, `next` and `stopped` between the main thread and the packing threads.
        readonly object sync = new object();
        int next;
        IEnumerator steps;
        volatile bool stopped;

        internal AnthroSpawn(AnthroRequest[] requests, AnthroSettings settings)
        {
            this.requests = requests;
            this.settings = settings;
            builds = new AnthroBuild[requests.Length];
            errors = new AnthroException[requests.Length];
            characters = new AnthroCharacter[requests.Length];
            // A job generates one body at a time: one job per core keeps all cores busy, with requests dealt out in turn.
            jobs = new AnthroJob[Math.Max(1, Math.Min(requests.Length, Math.Min(Environment.ProcessorCount, MaxJobs)))];
            packers = new Thread[jobs.Length];
            var model = settings.model ?? AnthroModel.Default;
            try
            {
                for (var i = 0; i < jobs.Length; i++)
                {
                    jobs[i] = model.StartJob(requests.Where((request, place) => place % jobs.Length == i).ToArray());
                }
                for (var i = 0; i < jobs.Length; i++)
                {
                    var job = i;
                    packers[i] = new Thread(() => Pack(job));
                    packers[i].Name = "AnthroNet packing";
                    packers[i].IsBackground = true;
                    packers[i].Start();
                }
            }
            catch
            {
                Dispose();
                throw;
            }
            AnthroAlive.Add(this);
        }

        const int MaxJobs = 16;

        /// <summary>How many characters each thread packs ahead of the main thread; one takes a few megabytes.</summary>
        const int MaxPackedAhead = 4;

        /// <summary>Raised for every complete and active character, with the index of its request.</summary>
        public event Action<int, AnthroCharacter> OnSpawned;

        /// <summary>Number of requests.</summary>
        public int Count
        {
            get { return requests.Length; }
        }

        /// <summary>Number of requests that have a character or an error.</summary>
        public int DoneCount
        {
            get { return next; }
        }

        /// <summary>Whether every request has a character or an error, or the spawn was disposed.</summary>
        public bool IsDone
        {
            get { return stopped || next == requests.Length; }
        }

        /// <summary>The character of a request; null before it is complete, and if it failed.</summary>
        public AnthroCharacter Character(int index)
        {
            return index < next ? characters[index] : null;
        }

        /// <summary>Why a request has no character; null if it has one, and before it is finished.</summary>
        public AnthroException Error(int index)
        {
            return index < next ? errors[index] : null;
        }

        /// <summary>
        /// Works for about the given time, on the main thread. Finishes a step once begun, and takes at least one step if
        /// there is anything to do.
        /// </summary>
        /// <returns>Whether the spawn is done.</returns>
        public bool Advance(double milliseconds)
        {
            watch.Restart();
            while (!IsDone)
            {
                if (!(steps == null ? BeginNext() : Step()))
                {
                    return false;
                }
                if (watch.Elapsed.TotalMilliseconds >= milliseconds)
                {
                    break;
                }
            }
            return IsDone;
        }

        /// <summary>Starts on the next request if it is packed.</summary>
        /// <returns>Whether it was packed.</returns>
        bool BeginNext()
        {
            AnthroBuild build;
            lock (sync)
            {
                build = builds[next];
                builds[next] = null;
                if (build == null)
                {
                    if (errors[next] == null)
                    {
                        return false;
                    }
                    FinishCurrent();
                    return true;
                }
            }
            characters[next] = AnthroFactory.CreateInactive(requests[next], settings);
            steps = characters[next].SetBodySteps(build);
            return true;
        }

        /// <summary>Takes a step of the current character. An exception becomes the error of that character
        /// alone.</summary>
        bool Step()
        {
            try
            {
                if (steps.MoveNext())
                {
                    return true;
                }
                if (characters[next] == null)
                {
                    throw new AnthroException(AnthroError.Cancelled, "the character was destroyed while it was made");
                }
            }
            catch (Exception error)
            {
                UnityEngine.Debug.LogException(error);
                errors[next] = error as AnthroException ?? new AnthroException(AnthroError.Other, error.Message);
                DestroyCurrent();
                FinishCurrent();
                return true;
            }
            steps = null;
            var place = next;
            characters[place].gameObject.SetActive(true);
            FinishCurrent();
            try
            {
                if (OnSpawned != null)
                {
                    OnSpawned(place, characters[place]);
                }
            }
            catch (Exception error)
            {
                UnityEngine.Debug.LogException(error);
            }
            return true;
        }

        void FinishCurrent()
        {
            lock (sync)
            {
                next++;
                Monitor.PulseAll(sync);
            }
        }

        /// <summary>Destroys the current, unfinished character.</summary>
        void DestroyCurrent()
        {
            ((IDisposable)steps).Dispose();
            steps = null;
            // If it was destroyed by others it compares equal to null, but still owns meshes and a body.
            characters[next].Release();
            if (characters[next] != null)
            {
                AnthroObjects.DestroySafely(characters[next].gameObject);
            }
            characters[next] = null;
        }

        /// <summary>Body of a packing thread: takes the bodies of a job as they are finished and packs them.</summary>
        void Pack(int job)
        {
            for (var i = job; i < requests.Length; i += jobs.Length)
            {
                lock (sync)
                {
                    while (!stopped && i >= next + MaxPackedAhead * jobs.Length)
                    {
                        Monitor.Wait(sync);
                    }
                    if (stopped)
                    {
                        return;
                    }
                }
                AnthroBuild build = null;
                AnthroException error = null;
                try
                {
                    build = PackOne(jobs[job], i / jobs.Length, out error);
                }
                catch (Exception other)
                {
                    error = other as AnthroException ?? new AnthroException(AnthroError.Other, other.Message);
                }
                lock (sync)
                {
                    builds[i] = build;
                    errors[i] = error;
                }
            }
        }

        AnthroBuild PackOne(AnthroJob job, int index, out AnthroException error)
        {
            AnthroBody body;
            while (!job.TryTake(index, out body, out error))
            {
                if (error != null || stopped)
                {
                    return null;
                }
                Thread.Sleep(1);
            }
            var build = new AnthroBuild(body, settings.skinTone, settings.bodyOnly);
            try
            {
                foreach (var lod in AnthroFigure.LodRange(settings.finestLod, settings.coarsestLod))
                {
                    if (stopped)
                    {
                        break;
                    }
                    // A pooled character needs less, but whether the pool will have one is not known yet.
                    build.Pack(lod, true);
                }
                return build;
            }
            catch
            {
                build.Dispose();
                body.Dispose();
                throw;
            }
        }

        /// <summary>Cancels what is not generated yet: those requests get the error `Cancelled`, finished characters
        /// stay.</summary>
        public void Cancel()
        {
            foreach (var job in jobs)
            {
                job.Cancel();
            }
        }

        /// <summary>Cancels, waits for the worker threads, and frees everything. Finished characters stay; an unfinished
        /// one is destroyed.</summary>
        public void Dispose()
        {
            lock (sync)
            {
                stopped = true;
                Monitor.PulseAll(sync);
            }
            foreach (var packer in packers)
            {
                if (packer != null && packer.IsAlive)
                {
                    packer.Join();
                }
            }
            foreach (var job in jobs)
            {
                if (job != null)
                {
                    job.Dispose();
                }
            }
            for (var i = 0; i < builds.Length; i++)
            {
                if (builds[i] != null)
                {
                    builds[i].Body.Dispose();
                    builds[i].Dispose();
                    builds[i] = null;
                }
            }
            if (steps != null)
            {
                DestroyCurrent();
            }
        }
    }
}
