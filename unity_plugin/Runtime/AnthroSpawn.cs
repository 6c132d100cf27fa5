using System;
using System.Collections;
using System.Diagnostics;
using System.Linq;
using System.Threading;
using Anthronet.Native;

namespace Anthronet
{
    /// <summary>
    /// Characters that are being made. Jobs of the library make the bodies, one thread beside each of them packs what the
    /// meshes will hold, and `Advance` makes the objects on the main thread.
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
        // Guards `builds`, `errors`, `next` and `stopped` between the main thread and those that pack.
        readonly object gate = new object();
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
            // A job makes one body after the other: as many as there are cores, taken from in turns, keep all of them busy.
            jobs = new AnthroJob[Math.Max(1, Math.Min(requests.Length, Math.Min(Environment.ProcessorCount, MostJobs)))];
            packers = new Thread[jobs.Length];
            var model = settings.model ?? AnthroModel.Default;
            try
            {
                for (var i = 0; i < jobs.Length; i++)
                {
                    jobs[i] = model.Start(requests.Where((request, place) => place % jobs.Length == i).ToArray());
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

        const int MostJobs = 16;

        /// <summary>How many are packed ahead of the main thread, by each thread: a packed character is some megabytes.
        /// </summary>
        const int Ahead = 4;

        /// <summary>Called for every character that is whole and awake, with its place.</summary>
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
            get { return stopped || next == requests.Length; }
        }

        /// <summary>A character, null before it is whole or where it failed.</summary>
        public AnthroCharacter Character(int index)
        {
            return index < next ? characters[index] : null;
        }

        /// <summary>Why there is no character; null where there is one or will be.</summary>
        public AnthroException Error(int index)
        {
            return index < next ? errors[index] : null;
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
                if (!(steps == null ? Begin() : Step()))
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

        /// <summary>Begins with the next that is packed.</summary>
        /// <returns>Whether it was.</returns>
        bool Begin()
        {
            AnthroBuild build;
            lock (gate)
            {
                build = builds[next];
                builds[next] = null;
                if (build == null)
                {
                    if (errors[next] == null)
                    {
                        return false;
                    }
                    Pass();
                    return true;
                }
            }
            characters[next] = AnthroFactory.Asleep(requests[next], settings);
            steps = characters[next].Steps(build);
            return true;
        }

        /// <summary>Takes a step of the character that is begun. What fails is the error of that one alone.</summary>
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
                Abandon();
                Pass();
                return true;
            }
            steps = null;
            var place = next;
            characters[place].gameObject.SetActive(true);
            Pass();
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

        void Pass()
        {
            lock (gate)
            {
                next++;
                Monitor.PulseAll(gate);
            }
        }

        /// <summary>Destroys the character that is begun.</summary>
        void Abandon()
        {
            ((IDisposable)steps).Dispose();
            steps = null;
            // One that others destroyed meanwhile is null to Unity, and what it owns is still there.
            characters[next].Release();
            if (characters[next] != null)
            {
                AnthroObjects.Discard(characters[next].gameObject);
            }
            characters[next] = null;
        }

        /// <summary>What a thread does: takes the bodies of a job as they are made and packs them.</summary>
        void Pack(int job)
        {
            for (var i = job; i < requests.Length; i += jobs.Length)
            {
                lock (gate)
                {
                    while (!stopped && i >= next + Ahead * jobs.Length)
                    {
                        Monitor.Wait(gate);
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
                lock (gate)
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

        /// <summary>Asks for no more characters: those that are whole stay, the others get the error `Cancelled`, unless
        /// their body is made already.</summary>
        public void Cancel()
        {
            foreach (var job in jobs)
            {
                job.Cancel();
            }
        }

        /// <summary>Cancels it, waits for what its threads are at, and frees all. Characters that are whole stay, one that is
        /// not is destroyed.</summary>
        public void Dispose()
        {
            lock (gate)
            {
                stopped = true;
                Monitor.PulseAll(gate);
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
                Abandon();
            }
        }
    }
}
