using System;
using System.Diagnostics;
using System.IO;
using System.Linq;
using System.Threading;
using NUnit.Framework;

namespace Anthronet.Tests
{
    /// Motion files, export and clips.
    [TestFixture]
    public static class ClipTests
    {
        [Test(Description = "exported files are read back as motions")]
        public static void Files()
        {
            var file = Path.Combine(Path.GetTempPath(), "anthronet-unity-test-" + Process.GetCurrentProcess().Id + ".glb");
            try
            {
                using (var body = NativeTests.Body())
                using (var walk = AnthroClip.Builtin("walk", body))
                {
                    body.Save(file, 3, walk);
                    using (var motion = AnthroMotion.Open(file))
                    {
                        Expect.Equal(1, motion.ClipCount, "clips");
                        Expect.Equal("walk", motion.ClipName(0), "its name");
                        Expect.That(motion.ReportJson.StartsWith("{"), "report");
                    }
                    using (var again = AnthroClip.Open(file, body, new AnthroRetargetOptions { inPlace = true }))
                    using (var memory = AnthroMotion.Open(File.ReadAllBytes(file), "person.glb"))
                    using (var third = memory.Retarget(body, 0, new AnthroRetargetOptions { mappingJson = "{}", framesPerSecond = 10 }))
                    {
                        Expect.Equal(walk.JointCount, again.JointCount, "joints");
                        Expect.Near(10, third.FramesPerSecond, 1e-9, "rate");
                    }
                    body.Save(file, 3, walk, walk);
                    using (var twice = AnthroMotion.Open(file))
                    {
                        Expect.Equal("walk, walk 2", twice.ClipName(0) + ", " + twice.ClipName(1), "two of one name");
                    }
                    Expect.Code(AnthroError.File, "", () => AnthroMotion.Open(new byte[0], "empty.bvh"), "an empty file");
                }
            }
            finally
            {
                File.Delete(file);
            }
        }

        [Test(Description = "clips are sampled, baked, blended")]
        public static void Clips()
        {
            Expect.That(AnthroClip.BuiltinNames().Contains("walk"), "walk");
            using (var body = NativeTests.Body())
            using (var walk = AnthroClip.Builtin("walk", body))
            using (var idle = AnthroClip.Builtin("idle", body))
            using (var slow = walk.Resample(10))
            using (var here = walk.InPlace())
            using (var round = walk.Looped(0.2))
            using (var both = walk.Blend(idle, 0.5f))
            using (var then = walk.Crossfade(idle, 0.2))
            {
                var frames = walk.Bake();
                var pose = new AnthroTransform[walk.JointCount];
                walk.Sample(0, AnthroWrap.Once, pose);
                Expect.That(frames.Take(pose.Length).SequenceEqual(pose), "the first frame is the pose at 0");
                Expect.Near(10, slow.FramesPerSecond, 1e-9, "rate");
                Expect.That(then.Duration > walk.Duration && both.FrameCount > 1 && round.FrameCount > 1, "durations");
                here.Sample(here.Duration, AnthroWrap.Once, pose, true);
                Expect.That(Math.Abs(pose[1].translation.z) < 0.2, "in place, yet at z " + pose[1].translation.z);
                using (var copy = AnthroClip.FromPoses(body, "copy \u00fc", walk.FramesPerSecond, frames))
                {
                    Expect.Equal("copy \u00fc", copy.Name, "name");
                    Expect.Equal(walk.FrameCount, copy.FrameCount, "frames");
                }
            }
        }

        static readonly string[] joints =
        {
            // Depth, name, offset; a lower depth closes the joints before.
            "0 Hips 0 95 0", "1 Spine 0 12 0", "2 Spine1 0 14 0", "3 Neck 0 25 0", "4 Head 0 12 0",
            "3 LeftShoulder 4 20 0", "4 LeftArm 14 0 0", "5 LeftForeArm 27 0 0", "6 LeftHand 25 0 0",
            "3 RightShoulder -4 20 0", "4 RightArm -14 0 0", "5 RightForeArm -27 0 0", "6 RightHand -25 0 0",
            "1 LeftUpLeg 9 -4 0", "2 LeftLeg 0 -42 0", "3 LeftFoot 0 -41 0", "4 LeftToeBase 0 -7 13",
            "1 RightUpLeg -9 -4 0", "2 RightLeg 0 -42 0", "3 RightFoot 0 -41 0", "4 RightToeBase 0 -7 13",
        };

        /// Three frames of a CMU-like skeleton, in centimetres.
        internal static readonly string Bvh = Skeleton() + "MOTION\nFrames: 3\nFrame Time: 0.0333333\n"
            + Frame(0) + Frame(10) + Frame(20);

        static string Skeleton()
        {
            var text = new System.Text.StringBuilder("HIERARCHY\n");
            var open = 0;
            for (var i = 0; i < joints.Length; i++)
            {
                var words = joints[i].Split(' ');
                var depth = int.Parse(words[0]);
                for (; open > depth; open--)
                {
                    text.Append("}\n");
                }
                text.Append(i == 0 ? "ROOT " : "JOINT ").Append(words[1]).Append("\n{\nOFFSET ")
                    .Append(string.Join(" ", words, 2, 3)).Append("\nCHANNELS ")
                    .Append(i == 0 ? "6 Xposition Yposition Zposition " : "3 ").Append("Zrotation Xrotation Yrotation\n");
                open++;
                var leaf = i + 1 == joints.Length || int.Parse(joints[i + 1].Split(' ')[0]) <= depth;
                if (leaf)
                {
                    text.Append("End Site\n{\nOFFSET 0 5 0\n}\n");
                }
            }
            for (; open > 0; open--)
            {
                text.Append("}\n");
            }
            return text.ToString();
        }

        /// A frame with the left arm raised.
        static string Frame(int degrees)
        {
            var numbers = joints.SelectMany((joint, i) => (i == 0 ? "0 95 0 " : "").Split(new[] { ' ' }, StringSplitOptions.RemoveEmptyEntries)
                .Concat(new[] { joint.Contains("LeftArm ") ? degrees.ToString() : "0", "0", "0" }));
            return string.Join(" ", numbers) + "\n";
        }

        [Test(Description = "a small BVH file is retargeted: frames, rate, the raised arm")]
        public static void FromBvh()
        {
            using (var body = NativeTests.Body())
            using (var motion = AnthroMotion.Open(System.Text.Encoding.ASCII.GetBytes(Bvh), "arm.bvh"))
            using (var clip = motion.Retarget(body))
            {
                Expect.Equal(3, clip.FrameCount, "frames");
                Expect.Near(30, clip.FramesPerSecond, 0.01, "rate");
                var hand = Enumerable.Range(0, body.JointCount).Single(i => body.JointName(i) == "hand_l");
                var pose = new AnthroTransform[clip.JointCount];
                clip.Sample(0, AnthroWrap.Once, pose, true);
                var before = pose[hand].translation;
                clip.Sample(clip.Duration, AnthroWrap.Once, pose, true);
                Expect.That(before.x < -0.4f, "the left hand is at x " + before.x);
                Expect.That(pose[hand].translation.y > before.y + 0.1f, "it is not lifted");
                Expect.That(motion.ReportJson.Contains("\"BVH\""), "report: " + motion.ReportJson);
                Expect.That(clip.ReportJson.Contains("\"confidence\"") && clip.Doubts.Length == 0, "doubts: " + string.Join("; ", clip.Doubts));
                var armless = new AnthroRetargetOptions { mappingJson = "{\"LeftArm\": null, \"LeftForeArm\": null, \"LeftHand\": null}" };
                using (var other = motion.Retarget(body, 0, armless))
                {
                    Expect.Equal("it lacks the left arm", string.Join("; ", other.Doubts), "doubts");
                }
                using (var walk = AnthroClip.Builtin("walk", body))
                {
                    Expect.That(walk.ReportJson == null && walk.Doubts.Length == 0, "report of a built-in clip");
                }
                Expect.Code(AnthroError.Request, "person", () => AnthroMotion.Open(System.Text.Encoding.ASCII.GetBytes(Bvh), "arm.bvh",
                    new AnthroMotionOptions { person = 2 }), "a second person");
                Expect.Code(AnthroError.File, "", () => AnthroMotion.Open(new byte[] { 1, 2, 3 }, "broken.bvh"), "no BVH");
                Expect.Code(AnthroError.File, "", () => AnthroMotion.Open(new byte[] { 1, 2, 3 }, "broken.fbx"), "no FBX");
                Expect.Code(AnthroError.File, "", () => AnthroMotion.Open(new byte[] { 1, 2, 3 }, "broken.npz"), "no npz");
            }
        }

        [Test(Description = "motion files of the shared folder are retargeted, one of each format")]
        public static void FromFiles()
        {
            // Beside the repository; ANTHRONET_CLIPS names another folder.
            var folder = Environment.GetEnvironmentVariable("ANTHRONET_CLIPS");
            if (string.IsNullOrEmpty(folder) || !Directory.Exists(folder))
            {
                Assert.Ignore("there is no folder of motion files: ANTHRONET_CLIPS is \"" + folder + "\"");
            }
            var formats = Directory.GetFiles(folder).Where(file => ".bvh .fbx .glb .gltf .npz".Split(' ').Contains(Path.GetExtension(file)))
                .GroupBy(file => Path.GetExtension(file)).Select(group => group.OrderBy(file => file, StringComparer.Ordinal).First()).ToArray();
            Expect.That(formats.Length > 0, "no motion files in " + folder);
            using (var body = NativeTests.Body())
            {
                foreach (var file in formats)
                {
                    using (var clip = AnthroClip.Open(file, body))
                    {
                        var pose = new AnthroTransform[clip.JointCount];
                        clip.Sample(clip.Duration / 2, AnthroWrap.Once, pose, true);
                        Expect.That(clip.FrameCount > 1 && pose.All(joint => !float.IsNaN(joint.translation.x)), file);
                        Console.WriteLine("   " + Path.GetFileName(file) + ": " + clip.FrameCount + " frames");
                    }
                }
            }
        }
    }
}
