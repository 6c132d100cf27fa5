using System;
using System.Diagnostics;
using System.Linq;
using UnityEngine;

namespace Anthronet.Tests
{
    /// Prints times with their targets. Machines differ and are shared: no time fails.
    static class Speed
    {
        internal static void Print(int avatars)
        {
            // Warm-up: compilation, caches, allocation.
            Spawn(1, 1);
            var spawn = Enumerable.Range(0, 15).Select(i => Milliseconds(() => Fill((ulong)i + 20))).OrderBy(t => t).ToArray();
            Line("spawn of LOD1, request to filled buffers (median of 15)", spawn[7], "ms", 10);
            var objects = Enumerable.Range(0, 15).Select(i => Milliseconds(() => Spawn((ulong)i + 20, 1))).OrderBy(t => t);
            Console.WriteLine("   the same with objects and avatar: {0:0.0} ms", objects.ElementAt(7));

            Parts();
            var request = new AnthroRequest { Seed = 4 };
            var character = AnthroFactory.Create(request, new AnthroSettings { finestLod = 1, coarsestLod = 1, humanoid = false });
            var update = Enumerable.Range(0, 15).Select(i => Milliseconds(() =>
            {
                request.Set("height", 1.6 + 0.01 * i);
                character.Request = request;
                character.Generate();
            })).OrderBy(t => t).ToArray();
            Line("change of a character at LOD1 in place (median of 15)", update[7], "ms", 10);
            UnityEngine.Object.Destroy(character.gameObject);

            using (var body = AnthroModel.Default.Generate(new AnthroRequest()))
            using (var clip = AnthroClip.Builtin("walk", body))
            using (var surface = new AnthroMesh(body, 1))
            using (var skinner = new AnthroSkinner(surface))
            using (var crowd = new AnthroCrowdSkin(Enumerable.Repeat(skinner, 20).ToArray(), clip.JointCount))
            {
                for (var i = 0; i < crowd.Count; i++)
                {
                    crowd.Pose(i, clip, 0.05 * i, AnthroWrap.Loop);
                }
                crowd.Run();
                var pose = new AnthroTransform[clip.JointCount];
                var sample = Milliseconds(() =>
                {
                    for (var i = 0; i < 1000; i++)
                    {
                        clip.Sample(0.001 * i, AnthroWrap.Loop, pose);
                    }
                });
                Console.WriteLine("   a pose of a clip: {0:0.0} us", sample);
                Console.WriteLine("   skinning of 20 characters at LOD1: {0:0.0} ms", Milliseconds(crowd.Run));
            }

            Line("longest step on the main thread of a character with LOD0 to LOD3 (median of 20)", Longest(0), "ms", AnthroRunner.Budget);
            Line("the same with LOD1 to LOD3", Longest(1), "ms", AnthroRunner.Budget);

            var requests = Enumerable.Range(1, avatars).Select(i => new AnthroRequest { Seed = (ulong)i }).ToArray();
            var whole = 0;
            var before = Resident();
            var characters = new AnthroCharacter[avatars];
            var took = Milliseconds(() =>
            {
                using (var job = AnthroFactory.CreateAsync(
                    requests, new AnthroSettings { finestLod = 1, coarsestLod = 1 }))
                {
                    while (!job.Advance(100))
                    {
                        System.Threading.Thread.Sleep(1);
                    }
                    for (var i = 0; i < avatars; i++)
                    {
                        characters[i] = job.Character(i);
                        whole += characters[i] == null ? 0 : 1;
                    }
                }
            });
            Line(whole + " characters at LOD1 with avatars by CreateAsync, per 1,000", took * 1000 / avatars / 1000, "s", 8);
            Console.WriteLine("   memory per character: {0:0} KiB, the stand-ins' managed meshes included",
                (Resident() - before) / 1024.0 / avatars);
            GC.KeepAlive(characters);
            Expect.Equal(avatars, whole, "characters");
        }

        /// The longest step of `Advance` for a character, median of several, milliseconds. The stand-ins copy meshes as
        /// Unity does; Unity's other work comes on top.
        static double Longest(int finest)
        {
            var requests = Enumerable.Range(1, 20).Select(i => new AnthroRequest { Seed = (ulong)i }).ToArray();
            var longest = new double[requests.Length];
            using (var spawn = AnthroFactory.CreateAsync(requests, new AnthroSettings { finestLod = finest }))
            {
                while (!spawn.IsDone)
                {
                    // Packing continues on its own thread meanwhile.
                    System.Threading.Thread.Sleep(2);
                    var at = spawn.DoneCount;
                    longest[at] = Math.Max(longest[at], Milliseconds(() => spawn.Advance(0)));
                }
                for (var i = 0; i < spawn.Count; i++)
                {
                    UnityEngine.Object.Destroy(spawn.Character(i).gameObject);
                }
            }
            return longest.OrderBy(t => t).ElementAt(longest.Length / 2);
        }

        static void Parts()
        {
            var made = new AnthroRequest { Seed = 3 }.Set("height", 1.7);
            AnthroBody body = null;
            AnthroMesh surface = null;
            Console.WriteLine("   of which: request to body {0:0.0} ms, to native surface {1:0.0} ms, to mesh {2:0.0} ms",
                Milliseconds(() => body = AnthroModel.Default.Generate(made)),
                Milliseconds(() => surface = new AnthroMesh(body, 1)),
                Milliseconds(() => UnityEngine.Object.Destroy(AnthroMeshes.Create(surface, body.Joints(), "x"))));
            surface.Dispose();
            body.Dispose();
        }

        static void Fill(ulong seed)
        {
            using (var body = AnthroModel.Default.Generate(new AnthroRequest { Seed = seed }.Set("height", 1.7)))
            using (var surface = new AnthroMesh(body, 1))
            {
                UnityEngine.Object.Destroy(AnthroMeshes.Create(surface, body.Joints(), "filled"));
            }
        }

        static void Spawn(ulong seed, int lod)
        {
            var made = AnthroFactory.Create(new AnthroRequest { Seed = seed }.Set("height", 1.7),
                new AnthroSettings { finestLod = lod, coarsestLod = lod });
            UnityEngine.Object.Destroy(made.gameObject);
        }

        static double Milliseconds(Action action)
        {
            var watch = Stopwatch.StartNew();
            action();
            return watch.Elapsed.TotalMilliseconds;
        }

        static void Line(string what, double found, string unit, double bar)
        {
            Console.WriteLine("   {0}: {1:0.0} {2} (bar {3} {2}){4}", what, found, unit, bar,
                found <= bar ? "" : " OVER THE BAR");
        }

        static long Resident()
        {
            GC.Collect();
            return Process.GetCurrentProcess().WorkingSet64;
        }
    }
}
