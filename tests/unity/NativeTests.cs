using System;
using System.Diagnostics;
using System.IO;
using System.Linq;
using System.Security.Cryptography;
using System.Threading;
using Anthronet.Native;

namespace Anthronet.Tests
{
    /// The wrappers without Unity: errors, lifetimes, jobs, the same bytes as everywhere.
    static class NativeTests
    {
        internal static AnthroBody Body(ulong seed = 7)
        {
            var request = new AnthroRequest { Sex = AnthroSex.Female, Seed = seed };
            return AnthroModel.Default.Generate(request.Set("height", 1.7).Set("waist_circumference", 0.8));
        }

        [Case("a missing or foreign library is told with its file")]
        static void Missing()
        {
            var error = Library.Missing(new DllNotFoundException("anthronet"));
            Expect.That(error.Message.Contains("Packages/com.anthronet.unity/Runtime/Plugins/Linux/x86_64/libanthronet.so"),
                error.Message);
            Library.CheckVersion(NativeMethods.ANTHRONET_ABI_VERSION);
            var version = Expect.Throws<DllNotFoundException>(() => Library.CheckVersion(99), "version 99");
            Expect.That(version.Message.Contains("99") && version.Message.Contains("1"), version.Message);
        }

        [Case("the version of the library is the package's")]
        static unsafe void Version()
        {
            anthronet_text version;
            anthronet_error error;
            Library.Check(NativeMethods.anthronet_version(&version, &error), &error);
            Expect.Equal(AnthroPackage.Version, Utf8.Text(version), "version");
        }

        [Case("measures are the library's, in its order")]
        static unsafe void Measures()
        {
            Expect.Equal((uint)AnthroMeasures.Count, NativeMethods.anthronet_measure_count(), "count");
            for (var i = 0u; i < AnthroMeasures.Count; i++)
            {
                anthronet_text name;
                anthronet_error error;
                Library.Check(NativeMethods.anthronet_measure_name(i, &name, &error), &error);
                Expect.Equal(Utf8.Text(name), AnthroMeasures.Names[(int)i], "measure " + i);
                double min, max;
                AnthroModel.Default.Range((int)i, out min, out max);
                Expect.That(0 < min && min < max && max < 3, AnthroMeasures.Names[(int)i] + ": " + min + " to " + max);
            }
        }

        [Case("requests come through JSON as they were")]
        static void Requests()
        {
            var request = new AnthroRequest
            {
                Sex = AnthroSex.Male, Seed = ulong.MaxValue, Fill = AnthroFill.Sample, Nearest = true,
            };
            request.Set("height", 1.83).Set("arm_length", 0.35).Set("foot_width_right", 0.1);
            var latent = new double[AnthroModel.Default.LatentSize];
            latent[0] = 0.1 + 0.2;
            latent[3] = -1e-7;
            request.Latent = latent;
            var again = AnthroRequest.FromJson(request.ToJson());
            Expect.Equal(request.ToJson(), again.ToJson(), "JSON");
            Expect.Equal(ulong.MaxValue, again.Seed, "seed");
            Expect.That(again.IsGiven(AnthroMeasures.IndexOf("arm_length_left")), "left arm");
            Expect.That(again.IsGiven(AnthroMeasures.IndexOf("arm_length_right")), "right arm");
            Expect.That(!again.IsGiven(AnthroMeasures.IndexOf("foot_width_left")), "left foot");
            Expect.That(again.Latent.SequenceEqual(latent), "latent");
            Expect.That(!again.Open("height").Copy().IsGiven(3), "opened");
            Expect.Equal(1.83, request[3], "the first is another one");
            Expect.That(new AnthroRequest().Latent == null, "no latent");
        }

        [Case("errors have their code and say why")]
        static void Errors()
        {
            var model = AnthroModel.Default;
            Expect.Code(AnthroError.Request, "shoe_size", () => new AnthroRequest().Set("shoe_size", 1), "unknown measure");
            Expect.Code(AnthroError.Request, "height", () => new AnthroRequest().Set("height", double.NaN), "no number");
            Expect.Code(AnthroError.Request, "height", () => model.Generate(new AnthroRequest().Set("height", 170)), "cm");
            Expect.Code(AnthroError.Request, "10 numbers", () => model.Generate(new AnthroRequest { Latent = new double[2] }),
                "latent");
            Expect.Code(AnthroError.Request, "", () => AnthroRequest.FromJson("{"), "JSON");
            Expect.Code(AnthroError.Request, "wa\u00efst", () => AnthroRequest.FromJson("{\"measures\":{\"wa\u00efst\":1}}"),
                "UTF-8 there and back");
            Expect.Code(AnthroError.Io, "nowhere", () => AnthroModel.Open("/nowhere/model\u20ac"), "model");
            Expect.Code(AnthroError.Model, "", () => AnthroModel.Open(new byte[0]), "empty model");
            Expect.Code(AnthroError.Enum, "sex", () => model.Generate(new AnthroRequest { Sex = (AnthroSex)9 }), "sex");
            Expect.Code(AnthroError.Index, "", () => { double a, b; model.Range(36, out a, out b); }, "range");
            Expect.Throws<ArgumentNullException>(() => model.Generate(null), "no request");
            Expect.Throws<ArgumentNullException>(() => AnthroModel.Open((string)null), "no path");
            Expect.Throws<OverflowException>(() => { double a, b; model.Range(-1, out a, out b); }, "negative index");
            using (var body = Body())
            {
                Expect.Code(AnthroError.Size, "36", () => body.Measures(new AnthroMeasureReport[2]), "few reports");
                Expect.Code(AnthroError.Size, "", () => body.Joints(new AnthroJoint[1]), "few joints");
                Expect.Code(AnthroError.Size, "", () => body.Joints(new AnthroJoint[0]), "no joints");
                Expect.Code(AnthroError.Request, "fly", () => AnthroClip.Builtin("fly", body), "clip");
                Expect.Code(AnthroError.Request, "docx", () => body.ToBytes("docx"), "format");
                Expect.Throws<AnthroException>(() => new AnthroSurface(body, 4), "level of detail");
                using (var clip = AnthroClip.Builtin("walk", body))
                {
                    Expect.Code(AnthroError.Request, "", () => clip.Sample(double.NaN, AnthroWrap.Loop,
                        new AnthroTransform[clip.JointCount]), "no time");
                }
            }
        }

        [Case("bodies have the measures that are asked for")]
        static void Bodies()
        {
            using (var body = Body())
            {
                var reports = body.Measures();
                Expect.Near(1.7, reports[3].obtained, 1e-4, "height");
                Expect.That(reports[3].Given && !reports[4].Given, "given");
                Expect.Equal(AnthroSex.Female, body.Sex, "sex");
                Expect.Equal(7ul, body.Seed, "seed");
                Expect.That(body.Converged && body.SolveResidual < 1e-4, "solve " + body.SolveResidual);
                Expect.That(body.Mass > 40 && body.Mass < 100 && body.Bmi > 15 && body.Volume > 0.03, "mass " + body.Mass);
                Expect.That(body.ReportJson.Contains("\"waist_circumference\""), "report");
                var latent = new double[AnthroModel.Default.LatentSize];
                body.Latent(latent);
                Expect.That(latent.Any(z => z != 0), "latent");
            }
            using (var half = AnthroModel.Default.Interpolate(new AnthroRequest { Sex = AnthroSex.Male }.Set("height", 1.6),
                new AnthroRequest { Sex = AnthroSex.Male }.Set("height", 1.8), 0.5))
            {
                Expect.Near(1.7, half.Measures()[3].obtained, 1e-3, "half the way");
            }
        }

        [Case("handles are freed once, in any order, and not under a call")]
        static void Lifetimes()
        {
            var model = AnthroModel.OpenEmbedded();
            var body = model.Generate(new AnthroRequest());
            var job = model.Start(new[] { new AnthroRequest { Seed = 3 } });
            model.Dispose();
            model.Dispose();
            Expect.Throws<ObjectDisposedException>(() => model.Generate(new AnthroRequest()), "model");
            Expect.Throws<ObjectDisposedException>(() => model.Start(new[] { new AnthroRequest() }), "model");
            var surface = new AnthroSurface(body, 2);
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
            // Nobody disposes of these: the finalisers do.
            for (var i = 0; i < 20; i++)
            {
                new AnthroSurface(last, 3);
                AnthroClip.Builtin("idle", last);
            }
            GC.Collect();
            GC.WaitForPendingFinalizers();
            last.Dispose();
        }

        [Case("many threads use one model, body and clip")]
        static void Threads()
        {
            using (var body = Body())
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
                        for (var k = 0; k < 200; k++)
                        {
                            clip.Sample(0.3, AnthroWrap.Loop, pose);
                            Expect.That(pose.SequenceEqual(expected), "another pose");
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

        [Case("jobs are polled, cancelled and taken from")]
        static void Jobs()
        {
            var requests = Enumerable.Range(1, 300).Select(i => new AnthroRequest { Seed = (ulong)i }).ToArray();
            requests[0] = new AnthroRequest().Set("height", 9);
            var watch = Stopwatch.StartNew();
            using (var job = AnthroModel.Default.Start(requests))
            {
                Expect.That(watch.ElapsedMilliseconds < 1000, "the start waits");
                Expect.Equal(300, job.Count, "count");
                Expect.Code(AnthroError.Busy, "", () => job.Take(299), "not there yet");
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
            using (var empty = AnthroModel.Default.Start(new AnthroRequest[0]))
            {
                Expect.Equal(0, empty.Count, "an empty job");
            }
        }

        [Case("same bytes: 200 requests through C#")]
        static void Same()
        {
            if (Runner.SameBytes == null || !File.Exists(Path.Combine(Runner.SameBytes, "requests.jsonl")))
            {
                throw new SkippedException("target/tmp/same_bytes is missing, the tests of ffi leave it");
            }
            var requests = File.ReadAllLines(Path.Combine(Runner.SameBytes, "requests.jsonl"));
            var expected = File.ReadAllLines(Path.Combine(Runner.SameBytes, "sha256.txt"));
            Expect.That(requests.Length == expected.Length && expected.Length >= 200, requests.Length + " requests");
            for (var i = 0; i < requests.Length; i++)
            {
                string line;
                try
                {
                    using (var body = AnthroModel.Default.Generate(AnthroRequest.FromJson(requests[i])))
                    using (var sha = SHA256.Create())
                    using (var walk = i % 10 == 3 ? AnthroClip.Builtin("walk", body) : null)
                    {
                        var clips = walk == null ? new AnthroClip[0] : new[] { walk };
                        line = string.Concat(sha.ComputeHash(body.ToBytes("glb", i % 4, clips)).Select(b => b.ToString("x2")));
                    }
                }
                catch (AnthroException error)
                {
                    line = "error " + (int)error.Code;
                }
                Expect.Equal(expected[i], line, "request " + i);
            }
        }

        [Case("files are written and read back as motions")]
        static void Files()
        {
            var file = Path.Combine(Path.GetTempPath(), "anthronet-unity-test-" + Process.GetCurrentProcess().Id + ".glb");
            try
            {
                using (var body = Body())
                using (var walk = AnthroClip.Builtin("walk", body))
                {
                    body.Save(file, 3, walk);
                    using (var motion = AnthroMotion.Open(file))
                    {
                        Expect.Equal(1, motion.ClipCount, "clips");
                        Expect.Equal("walk", motion.ClipName(0), "its name");
                        Expect.That(motion.ReportJson.StartsWith("{"), "report");
                    }
                    using (var again = AnthroClip.Open(file, body, new AnthroRetarget { inPlace = true }))
                    using (var memory = AnthroMotion.Open(File.ReadAllBytes(file), "person.glb"))
                    using (var third = memory.Onto(body, 0, new AnthroRetarget { mappingJson = "{}", framesPerSecond = 10 }))
                    {
                        Expect.Equal(walk.JointCount, again.JointCount, "joints");
                        Expect.Near(10, third.FramesPerSecond, 1e-9, "rate");
                    }
                    Expect.Code(AnthroError.Invalid, "", () => body.Save(file, 3, walk, walk), "two of one name");
                    Expect.Code(AnthroError.File, "", () => AnthroMotion.Open(new byte[0], "empty.bvh"), "an empty file");
                }
            }
            finally
            {
                File.Delete(file);
            }
        }

        [Case("clips are sampled, baked, blended")]
        static void Clips()
        {
            Expect.That(AnthroClip.BuiltinNames().Contains("walk"), "walk");
            using (var body = Body())
            using (var walk = AnthroClip.Builtin("walk", body))
            using (var idle = AnthroClip.Builtin("idle", body))
            using (var slow = walk.Resampled(10))
            using (var here = walk.InPlace())
            using (var round = walk.Looped(0.2))
            using (var both = walk.Blended(idle, 0.5f))
            using (var then = walk.Then(idle, 0.2))
            {
                var frames = walk.Bake();
                var pose = new AnthroTransform[walk.JointCount];
                walk.Sample(0, AnthroWrap.Once, pose);
                Expect.That(frames.Take(pose.Length).SequenceEqual(pose), "the first frame is the pose at 0");
                Expect.Near(10, slow.FramesPerSecond, 1e-9, "rate");
                Expect.That(then.Duration > walk.Duration && both.FrameCount > 1 && round.FrameCount > 1, "durations");
                here.Sample(here.Duration, AnthroWrap.Once, pose, true);
                Expect.That(Math.Abs(pose[1].translation.z) < 0.2, "in place, yet at z " + pose[1].translation.z);
                using (var copy = AnthroClip.Of(body, "copy \u00fc", walk.FramesPerSecond, frames))
                {
                    Expect.Equal("copy \u00fc", copy.Name, "name");
                    Expect.Equal(walk.FrameCount, copy.FrameCount, "frames");
                }
            }
        }
    }
}
