using System;
using System.Collections.Generic;
using System.Linq;
using NUnit.Framework;
using UnityEngine;

namespace Anthronet.Tests
{
    /// Spawning over several frames, and pools.
    [TestFixture]
    public static class SpawnTests
    {
        [Test(Description = "characters spawn over several frames, some fail, some are cancelled")]
        public static void Spawn()
        {
            var requests = Enumerable.Range(1, 6).Select(i => new AnthroRequest { Seed = (ulong)i }).ToArray();
            requests[2].Set("height", 9);
            var settings = new AnthroSettings { finestLod = 2, coarsestLod = 3 };
            var spawned = new List<int>();
            var spawn = AnthroFactory.CreateAsync(requests, settings);
            requests[0].Set("height", 9);
            spawn.OnSpawned += (i, character) => spawned.Add(i);
            var frames = 0;
            while (!spawn.Advance(0))
            {
                frames++;
                System.Threading.Thread.Sleep(1);
                Expect.That(frames < 30000, "never done");
            }
            Expect.That(frames > 5 * 5, "only " + frames + " frames: a budget of nothing does one step a frame");
            Expect.Equal("0 1 3 4 5", string.Join(" ", spawned), "spawned");
            Expect.Equal(AnthroError.Request, spawn.Error(2).Code, "its error");
            Expect.That(spawn.Character(2) == null && spawn.Character(5).Body.Seed == 6, "characters");
            spawn.Dispose();
            foreach (var i in spawned)
            {
                UnityEngine.Object.Destroy(spawn.Character(i).gameObject);
            }
            var many = AnthroFactory.CreateAsync(Enumerable.Repeat(new AnthroRequest { Seed = 5 }, 200).ToArray(), settings);
            many.Cancel();
            while (!many.Advance(50))
            {
            }
            var whole = Enumerable.Range(0, 200).Count(i => many.Character(i) != null);
            Expect.That(whole < 200 && many.Error(199).Code == AnthroError.Cancelled, whole + " although cancelled");
            for (var i = 0; i < 200; i++)
            {
                UnityEngine.Object.Destroy(many.Character(i) == null ? null : many.Character(i).gameObject);
            }
            many.Dispose();
        }

        [Test(Description = "disposing a spawn leaves nothing half made")]
        public static void Halfway()
        {
            var spawn = AnthroFactory.CreateAsync(new[] { new AnthroRequest() }, new AnthroSettings { finestLod = 2 });
            var before = UnityEngine.Object.Alive;
            while (UnityEngine.Object.Alive == before)
            {
                spawn.Advance(0);
            }
            Expect.That(!spawn.IsDone, "it is done in one step");
            spawn.Dispose();
            spawn.Dispose();
            Expect.Equal(before, UnityEngine.Object.Alive, "objects that are alive");
            Expect.That(spawn.Advance(1) && spawn.Character(0) == null, "it continues");
        }

        [Test(Description = "one job per core, and no more than requests")]
        public static void Jobs()
        {
            var settings = new AnthroSettings { finestLod = 3, coarsestLod = 3 };
            foreach (var count in new[] { 0, 1, 40 })
            {
                using (var spawn = AnthroFactory.CreateAsync(Enumerable.Repeat(new AnthroRequest(), count).ToArray(), settings))
                {
                    var jobs = (AnthroJob[])Scene.Field(spawn, "jobs");
                    Expect.Equal(Math.Max(1, Math.Min(count, Math.Min(16, Environment.ProcessorCount))), jobs.Length, "jobs");
                    Expect.Equal(count == 0, spawn.IsDone, "done");
                }
            }
        }

        [Test(Description = "an exception on the main thread is the error of that character alone, and handlers that throw stop nothing")]
        public static void Thrown()
        {
            var settings = new AnthroSettings { finestLod = 3, coarsestLod = 3 };
            // Make the materials first: they stay cached.
            Scene.Destroy(Scene.Character(3, 3));
            var alive = UnityEngine.Object.Alive;
            using (var spawn = AnthroFactory.CreateAsync(
                Enumerable.Range(1, 4).Select(i => new AnthroRequest { Seed = (ulong)i }).ToArray(), settings))
            {
                spawn.OnSpawned += (i, character) =>
                {
                    if (i == 1)
                    {
                        throw new InvalidOperationException("a handler");
                    }
                };
                Debug.Errors.Clear();
                var half = (AnthroCharacter[])Scene.Field(spawn, "characters");
                // A zero budget takes one step per call: destroys the third character while it is being made.
                while (!spawn.Advance(0))
                {
                    if (spawn.DoneCount == 2 && half[2] != null)
                    {
                        UnityEngine.Object.Destroy(half[2].gameObject);
                    }
                    System.Threading.Thread.Sleep(1);
                }
                Expect.That(Debug.Errors.Any(error => error.Contains("a handler")), "the handler's exception is not logged");
                Debug.Errors.Clear();
                for (var i = 0; i < 4; i++)
                {
                    Expect.Equal(i != 2, spawn.Character(i) != null, "character " + i);
                    Expect.Equal(i == 2, spawn.Error(i) != null && spawn.Error(i).Code == AnthroError.Cancelled, "error " + i);
                    UnityEngine.Object.Destroy(spawn.Character(i) == null ? null : spawn.Character(i).gameObject);
                }
            }
            Expect.Equal(alive, UnityEngine.Object.Alive, "objects that are alive");
        }

        [Test(Description = "nothing is visible before it is complete")]
        public static void Asleep()
        {
            using (var spawn = AnthroFactory.CreateAsync(new[] { new AnthroRequest() }, new AnthroSettings { finestLod = 2 }))
            {
                var parent = new GameObject("parent").transform;
                using (var other = AnthroFactory.CreateAsync(
                    new[] { new AnthroRequest() }, new AnthroSettings { finestLod = 2, parent = parent }))
                {
                    while (!other.Advance(0))
                    {
                        Expect.That(parent.childCount == 0 || !parent.GetChild(0).gameObject.activeSelf, "active while unfinished");
                    }
                    Expect.That(parent.GetChild(0).gameObject.activeSelf, "inactive when finished");
                }
                UnityEngine.Object.Destroy(parent.gameObject);
            }
        }

        static void Frames(Func<bool> until)
        {
            for (var frame = 0; !until(); frame++)
            {
                Expect.That(frame < 30000, "never done");
                System.Threading.Thread.Sleep(1);
                MonoBehaviour.Send((AnthroRunner)Scene.Static(typeof(AnthroRunner), "runner"), "Update");
            }
        }

        [Test(Description = "the runner advances spawns every frame, disposes finished ones, and continues if one throws")]
        public static void Running()
        {
            var settings = new AnthroSettings { finestLod = 3, coarsestLod = 3 };
            var first = AnthroRunner.Run(AnthroFactory.CreateAsync(new[] { new AnthroRequest() }, settings));
            var second = AnthroRunner.Run(AnthroFactory.CreateAsync(new[] { new AnthroRequest { Seed = 2 } }, settings));
            // Break it, so that it throws.
            typeof(AnthroSpawn).GetField("requests", System.Reflection.BindingFlags.Instance
                | System.Reflection.BindingFlags.NonPublic).SetValue(second, null);
            Debug.Errors.Clear();
            Frames(() => first.IsDone && AnthroRunner.Count == 0);
            Expect.That(Debug.Errors.Any(error => error.Contains("NullReference")), "the exception is not logged");
            Debug.Errors.Clear();
            Expect.Throws<ObjectDisposedException>(first.Cancel, "it is not freed");
            Scene.Destroy(first.Character(0));
        }

        [Test(Description = "the runner ends with play mode, and in edit mode the editor drives it")]
        public static void RunnerEnds()
        {
            var settings = new AnthroSettings { finestLod = 3, coarsestLod = 3 };
            var requests = Enumerable.Repeat(new AnthroRequest(), 50).ToArray();
            var spawn = AnthroRunner.Run(AnthroFactory.CreateAsync(requests, settings));
            var runner = (AnthroRunner)Scene.Static(typeof(AnthroRunner), "runner");
            Expect.That((runner.gameObject.hideFlags & HideFlags.DontSave) == 0, "it would outlive the play mode");
            UnityEngine.Object.Destroy(runner.gameObject);
            Expect.Throws<ObjectDisposedException>(spawn.Cancel, "its spawn is not freed");
            using (Scene.EditMode())
            {
                var edited = AnthroRunner.Run(AnthroFactory.CreateAsync(new[] { new AnthroRequest() }, settings));
                while (!edited.IsDone || AnthroRunner.Count > 0)
                {
                    UnityEditor.EditorApplication.update();
                }
                Expect.That(UnityEditor.EditorApplication.update == null, "the editor still calls it");
                Scene.Destroy(edited.Character(0));
                var left = AnthroRunner.Run(AnthroFactory.CreateAsync(requests, settings));
                UnityEditor.EditorApplication.update();
                UnityEditor.EditorApplication.Raise(UnityEditor.PlayModeStateChange.ExitingEditMode);
                Expect.Throws<ObjectDisposedException>(left.Cancel, "not freed before the play mode");
                Expect.Equal(0, AnthroRunner.Count, "spawns");
                foreach (var i in Enumerable.Range(0, 50).Where(i => left.Character(i) != null))
                {
                    Scene.Destroy(left.Character(i));
                }
                UnityEditor.EditorApplication.update();
            }
        }

        [Test(Description = "before a domain reload threads stop and native memory is released")]
        public static void ReleasedBeforeReload()
        {
            var body = AnthroModel.Default.Generate(new AnthroRequest());
            var clip = AnthroClip.Builtin("walk", body);
            var surface = new AnthroMesh(body, 3);
            var skinner = new AnthroSkinner(surface);
            var crowd = new AnthroCrowdSkin(new[] { skinner }, clip.JointCount);
            var spawn = AnthroFactory.CreateAsync(Enumerable.Repeat(new AnthroRequest(), 50).ToArray());
            System.Runtime.CompilerServices.RuntimeHelpers.RunClassConstructor(typeof(Editor.AnthroReload).TypeHandle);
            UnityEditor.AssemblyReloadEvents.Raise();
            Expect.Throws<ObjectDisposedException>(() => body.Joints(), "body");
            Expect.Throws<ObjectDisposedException>(() => clip.Bake(), "clip");
            Expect.Throws<ObjectDisposedException>(() => crowd.Run(), "crowd");
            Expect.Throws<ObjectDisposedException>(spawn.Cancel, "spawn");
            var packers = (System.Threading.Thread[])Scene.Field(spawn, "packers");
            Expect.That(packers.All(thread => !thread.IsAlive), "threads run on");
            // New objects work afterwards.
            using (var again = AnthroModel.Default.Generate(new AnthroRequest()))
            {
                Expect.Equal(0ul, again.Seed, "seed");
            }
        }

        [Test(Description = "the pool reuses characters: inactive, without handlers and clip, each of them once")]
        public static void Pool()
        {
            var pool = new AnthroPool();
            var settings = new AnthroSettings { finestLod = 3, coarsestLod = 3, pool = pool };
            var first = AnthroFactory.Create(new AnthroRequest { Seed = 1 }, settings);
            var reports = 0;
            first.OnGenerated += body => reports++;
            var animator = first.gameObject.AddComponent<AnthroAnimator>();
            animator.Play("walk");
            pool.Release(first);
            pool.Release(first);
            Expect.Equal(1, pool.Count, "in the pool");
            Expect.That(!first.gameObject.activeSelf && animator.Clip == null, "active, or still playing");
            var taken = pool.Get();
            Expect.That(ReferenceEquals(first, taken) && !taken.gameObject.activeSelf, "active with the old body");
            pool.Release(taken);
            var second = AnthroFactory.Create(new AnthroRequest { Seed = 2 }, settings);
            Expect.That(ReferenceEquals(first, second) && second.gameObject.activeSelf, "the same character, active");
            Expect.Equal(2ul, second.Body.Seed, "another person");
            Expect.Equal(0, reports, "events of the previous user");
            Debug.Errors.Clear();
            Expect.That(second.gameObject.AddComponent<AnthroAnimator>() == null && Debug.Errors.Count == 1, "two animators");
            Debug.Errors.Clear();
            animator.Play("idle");
            var joint = Scene.WorldPosition(second.Rig.Find("hand_l"));
            second.Request.Set("height", 1.55);
            second.Generate();
            Expect.That((Scene.WorldPosition(second.Rig.Find("hand_l")) - joint).magnitude > 0.01f, "it does not follow");
            pool.Release(second);
            UnityEngine.Object.Destroy(second.gameObject);
            Expect.That(pool.Get() == null, "a destroyed one is not given");
            var third = AnthroFactory.Create(new AnthroRequest { Seed = 3 }, settings);
            pool.Release(third);
            pool.Clear();
            Expect.That(third == null && pool.Count == 0, "not cleared");
        }
    }
}
