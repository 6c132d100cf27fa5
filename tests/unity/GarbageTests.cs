using System;
using System.Linq;
using System.Reflection;
using NUnit.Framework;
using UnityEngine;

namespace Anthronet.Tests
{
    /// What runs every frame allocates no managed memory.
    [TestFixture]
    public static class GarbageTests
    {
        // The compiler's reference assemblies lack this counter.
        static readonly Func<long> Allocated = (Func<long>)Delegate.CreateDelegate(typeof(Func<long>),
            typeof(GC).GetMethod("GetAllocatedBytesForCurrentThread", BindingFlags.Static | BindingFlags.Public | BindingFlags.NonPublic));

        static void Nothing(string what, int times, Action frame)
        {
            // The first run is compiled just in time.
            frame();
            var before = Allocated();
            for (var i = 0; i < times; i++)
            {
                frame();
            }
            Expect.Equal(0L, Allocated() - before, what + ": bytes in " + times + " frames");
        }

        static unsafe void Skin(AnthroContext context, AnthroSkinJob[] jobs)
        {
            fixed (AnthroSkinJob* first = jobs)
            {
                AnthroSkin.Run(context.Pointer, first, jobs.Length);
            }
        }

        [Test(Description = "zero bytes of managed memory per frame: sampling, animating, skinning a crowd, polling")]
        public static void PerFrame()
        {
            var start = Allocated();
            GC.KeepAlive(new byte[100]);
            Expect.That(Allocated() - start >= 100, "the counter does not count");
            var character = AnthroFactory.Create(new AnthroRequest(), new AnthroSettings { finestLod = 3, coarsestLod = 3 });
            var animator = character.gameObject.AddComponent<AnthroAnimator>();
            animator.Play("walk");
            var clip = animator.Clip;
            var pose = new AnthroTransform[clip.JointCount];
            var context = new AnthroContext();
            Nothing("sampling", 2000, () => clip.Sample(0.2, AnthroWrap.Loop, pose));
            Nothing("sampling in a context", 2000, () => clip.Sample(0.2, AnthroWrap.Loop, pose, false, context));
            Nothing("animator", 2000, () => animator.Advance(1f / 60));
            using (var other = AnthroModel.Default.Generate(new AnthroRequest { Seed = 2 }))
            {
                character.AddBlendShape("other", other);
            }
            Nothing("weights of blend shapes", 1000, () => character.SetBlendShapeWeight("other", 30f));
            var poseDriven = character.gameObject.AddComponent<AnthroPoseDrivenShapes>();
            Nothing("pose-driven shapes", 1000, poseDriven.Apply);
            var reports = new AnthroMeasureReport[AnthroMeasures.Count];
            Nothing("reports", 1000, () => character.Body.Measures(reports));
            using (var surface = new AnthroMesh(character.Body, 3))
            using (var skinner = new AnthroSkinner(surface))
            using (var crowd = new AnthroCrowdSkin(Enumerable.Repeat(skinner, 8).ToArray(), clip.JointCount))
            {
                Nothing("crowd", 300, () =>
                {
                    for (var i = 0; i < 8; i++)
                    {
                        crowd.Pose(i, clip, 0.1 * i, AnthroWrap.RootMotion);
                    }
                    crowd.Run();
                });
                var jobs = crowd.Jobs;
                Nothing("skinning as Burst calls it", 300, () => Skin(context, jobs));
            }
            context.Dispose();
            using (var job = AnthroModel.Default.StartJob(new[] { new AnthroRequest() }))
            {
                int done;
                Nothing("polling", 2000, () => job.Poll(out done));
            }
            UnityEngine.Object.Destroy(character.gameObject);
        }
    }
}
