using System;
using System.Diagnostics;
using System.IO;
using System.Linq;
using System.Threading;
using NUnit.Framework;

namespace Anthronet.Tests
{
    /// Lifetimes of native objects, threads, jobs.
    [TestFixture]
    public static class LifetimeTests
    {
        [Test(Description = "native objects are freed once, in any order, and not during a call")]
        public static void Lifetimes()
        {
            var model = AnthroModel.OpenEmbedded();
            var body = model.Generate(new AnthroRequest());
            var job = model.StartJob(new[] { new AnthroRequest { Seed = 3 } });
            model.Dispose();
            model.Dispose();
            Expect.Throws<ObjectDisposedException>(() => model.Generate(new AnthroRequest()), "model");
            Expect.Throws<ObjectDisposedException>(() => model.StartJob(new[] { new AnthroRequest() }), "model");
            var surface = new AnthroMesh(body, 2);
            var clip = AnthroClip.Builtin("idle", body);
            body.Dispose();
            Expect.Throws<ObjectDisposedException>(() => body.Joints(), "body");
            Expect.Throws<ObjectDisposedException>(() => AnthroClip.Builtin("idle", body), "body");
            Expect.Throws<ObjectDisposedException>(() => body.ToBytes("glb"), "body");
            var skinner = new AnthroSkinner(surface);
            surface.Dispose();
            Expect.Throws<ObjectDisposedException>(() => new AnthroSkinner(surface), "surface");
            var crowd = new AnthroCrowdSkin(new[] { skinner, skinner }, clip.JointCount);
            // The crowd still holds it.
            skinner.Dispose();
            crowd.Pose(0, clip, 0.1, AnthroWrap.Loop);
            crowd.Pose(1, clip, 0.1, AnthroWrap.Loop);
            var context = new AnthroContext();
            context.Dispose();
            Expect.Equal(IntPtr.Zero, context.Pointer, "pointer of a disposed context");
            Expect.Throws<ObjectDisposedException>(
                () => clip.Sample(0, AnthroWrap.Once, new AnthroTransform[clip.JointCount], false, context), "context");
            clip.Dispose();
            Expect.Throws<ObjectDisposedException>(() => crowd.Pose(0, clip, 0, AnthroWrap.Loop), "clip");
            crowd.Run();
            crowd.Dispose();
            crowd.Dispose();
            Expect.Throws<ObjectDisposedException>(() => crowd.Run(), "crowd");
            Expect.Throws<ObjectDisposedException>(() => new AnthroCrowdSkin(new[] { skinner }, 1), "skinner");
            int done;
            while (job.Poll(out done) == AnthroJobState.Running)
            {
                Thread.Sleep(1);
            }
            var last = job.Take(0);
            job.Dispose();
            Expect.Equal(3ul, last.Seed, "a body outlives its job and model");
            // Nobody disposes these: the finalisers do.
            for (var i = 0; i < 20; i++)
            {
                new AnthroMesh(last, 3);
                AnthroClip.Builtin("idle", last);
            }
            GC.Collect();
            GC.WaitForPendingFinalizers();
            last.Dispose();
        }

        [Test(Description = "many threads use one model, body and clip")]
        public static void Threads()
        {
            using (var body = NativeTests.Body())
            using (var clip = AnthroClip.Builtin("walk", body))
            {
                var expected = new AnthroTransform[clip.JointCount];
                clip.Sample(0.3, AnthroWrap.Loop, expected);
                Exception failed = null;
                var threads = Enumerable.Range(0, 4).Select(i => new Thread(() =>
                {
                    try
                    {
                        var pose = new AnthroTransform[clip.JointCount];
                        using (var context = new AnthroContext())
                        {
                            for (var k = 0; k < 200; k++)
                            {
                                clip.Sample(0.3, AnthroWrap.Loop, pose, false, k % 2 == 0 ? context : null);
                                Expect.That(pose.SequenceEqual(expected), "another pose");
                            }
                        }
                        using (var other = AnthroModel.Default.Generate(new AnthroRequest { Seed = (ulong)i }))
                        {
                            Expect.Equal((ulong)i, other.Seed, "seed");
                        }
                    }
                    catch (Exception error)
                    {
                        failed = error;
                    }
                })).ToArray();
                Array.ForEach(threads, thread => thread.Start());
                Array.ForEach(threads, thread => thread.Join());
                Expect.That(failed == null, "" + failed);
            }
        }

        [Test(Description = "jobs are polled, cancelled and taken from")]
        public static void Jobs()
        {
            var requests = Enumerable.Range(1, 300).Select(i => new AnthroRequest { Seed = (ulong)i }).ToArray();
            requests[0] = new AnthroRequest().Set("height", 9);
            var watch = Stopwatch.StartNew();
            using (var job = AnthroModel.Default.StartJob(requests))
            {
                Expect.That(watch.ElapsedMilliseconds < 1000, "the start waits");
                Expect.Equal(300, job.Count, "count");
                Expect.Code(AnthroError.Busy, "", () => job.Take(299), "not finished");
                AnthroBody body;
                AnthroException error;
                while (!job.TryTake(1, out body, out error))
                {
                    Expect.That(error == null, "" + error);
                    Thread.Sleep(1);
                }
                Expect.Equal(2ul, body.Seed, "seed");
                body.Dispose();
                Expect.Code(AnthroError.Taken, "", () => job.Take(1), "twice");
                Expect.Code(AnthroError.Request, "height", () => job.Take(0), "its own error");
                Expect.Code(AnthroError.Index, "", () => job.Take(300), "beyond");
                job.Cancel();
                int done;
                while (job.Poll(out done) == AnthroJobState.Running)
                {
                    Thread.Sleep(1);
                }
                Expect.Equal(AnthroJobState.Cancelled, job.Poll(out done), "state");
                Expect.That(done < 300, "all were made");
                Expect.Code(AnthroError.Cancelled, "", () => job.Take(299), "will not be");
            }
            using (var empty = AnthroModel.Default.StartJob(new AnthroRequest[0]))
            {
                Expect.Equal(0, empty.Count, "an empty job");
            }
        }
    }
}
