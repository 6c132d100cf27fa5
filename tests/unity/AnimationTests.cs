using System;
using System.Collections.Generic;
using System.Linq;
using NUnit.Framework;
using UnityEngine;

namespace Anthronet.Tests
{
    /// Motion in the scene.
    [TestFixture]
    public static class AnimationTests
    {
        [Test(Description = "the animator poses the joints as the clip says")]
        public static void Animate()
        {
            var character = Scene.Character(3, 3);
            var animator = character.gameObject.AddComponent<AnthroAnimator>();
            animator.Play("walk");
            animator.Advance(0.4f);
            var pose = new AnthroTransform[animator.Clip.JointCount];
            animator.Clip.Sample((double)0.4f, AnthroWrap.Loop, pose, true);
            for (var i = 0; i < pose.Length; i++)
            {
                var found = character.Rig.Bones[i].localToWorldMatrix;
                var off = new Vector3(found.m03, found.m13, found.m23) - pose[i].translation;
                Expect.That(off.magnitude < 1e-5, character.Rig.Bones[i].name + " is off by " + off);
            }
            var own = animator.Clip;
            animator.Play((AnthroClip)null);
            Expect.Throws<ObjectDisposedException>(() => own.Bake(), "its own clip is freed");
            character.Rig.ApplyBindPose();
            UnityEngine.Object.Destroy(character.gameObject);
        }

        /// Compares curves with the library's own sampling, at their keys and between them.
        static void Compare(AnimationClip made, AnthroClip clip, AnthroRig rig, string prefix)
        {
            Expect.Equal(clip.Name, made.name, "name");
            Expect.Near(clip.FramesPerSecond, made.frameRate, 1e-3, "rate");
            Expect.That(made.Continuous, "quaternion continuity is not ensured");
            var rotation = "xyzw".Select(axis => prefix + "ocalRotation." + axis).ToArray();
            var position = "xyz".Select(axis => prefix + "ocalPosition." + axis).ToArray();
            var pose = new AnthroTransform[clip.JointCount];
            int moving = 0, flips = 0;
            for (var joint = 0; joint < clip.JointCount; joint++)
            {
                var path = rig.Path(joint) + ":";
                Expect.That(Find(rig, path) == rig.Bones[joint], path + " leads to another joint");
                var q = rotation.Select(name => made.Curves[path + name].keys).ToArray();
                var moves = made.Curves.ContainsKey(path + position[0]);
                moving += moves ? 1 : 0;
                Expect.That(moves || joint > 1, "no positions of " + path);
                Expect.Equal(clip.FrameCount, q[0].Length, "keys of " + path);
                for (var frame = 0; frame < clip.FrameCount; frame++)
                {
                    clip.Sample(frame / clip.FramesPerSecond, AnthroWrap.Once, pose);
                    Expect.Near(frame / clip.FramesPerSecond, q[0][frame].time, 1e-5, "time");
                    var found = new Quaternion(q[0][frame].value, q[1][frame].value, q[2][frame].value, q[3][frame].value);
                    Expect.Near(1, Math.Abs(Quaternion.Dot(found, pose[joint].rotation)), 1e-5, path + " frame " + frame);
                    if (frame > 0)
                    {
                        var before = new Quaternion(
                            q[0][frame - 1].value, q[1][frame - 1].value, q[2][frame - 1].value, q[3][frame - 1].value);
                        flips += Quaternion.Dot(before, found) < 0 ? 1 : 0;
                    }
                    var place = moves ? new Vector3(made.Curves[path + position[0]].keys[frame].value,
                        made.Curves[path + position[1]].keys[frame].value, made.Curves[path + position[2]].keys[frame].value)
                        : rig.Joints[joint].parentFromJoint.translation;
                    Expect.That((place - pose[joint].translation).magnitude < 2e-6, path + " frame " + frame + " has another position");
                }
                // Half way between two frames: linear interpolation, which is close to the quaternion on the arc.
                var half = 1.5 / clip.FramesPerSecond;
                clip.Sample(half, AnthroWrap.Once, pose);
                var between = rotation.Select(name => (double)made.Curves[path + name].Evaluate((float)half)).ToArray();
                var length = Math.Sqrt(between.Sum(x => x * x));
                var r = pose[joint].rotation;
                var dot = (between[0] * r.x + between[1] * r.y + between[2] * r.z + between[3] * r.w) / length;
                Expect.Near(1, Math.Abs(dot), 1e-4, path + " between frames");
            }
            Expect.Equal(0, flips, "signs that change");
            Expect.That(moving >= 2 && moving < clip.JointCount, moving + " joints have positions");
        }

        static Transform Find(AnthroRig rig, string path)
        {
            var names = path.TrimEnd(':').Split('/');
            var at = rig.Bones[0];
            Expect.Equal(at.name, names[0], "the first of " + path);
            return names.Skip(1).Aggregate(at, (parent, name) => parent.Find(name));
        }

        [Test(Description = "animation clips have the keys that the library samples: legacy at run time, not in the editor")]
        public static void Baked()
        {
            var character = Scene.Character(3, 3);
            foreach (var name in new[] { "walk", "range_of_motion" })
            {
                using (var clip = AnthroClip.Builtin(name, character.Body))
                {
                    var made = clip.ToAnimationClip(character.Rig);
                    Expect.That(made.legacy, "not legacy");
                    Compare(made, clip, character.Rig, "l");
                    var edited = Editor.AnthroSave.ToAnimationClip(clip, character.Rig, true);
                    Expect.That(!edited.legacy && edited.Loops, "legacy, or without its loop");
                    Compare(edited, clip, character.Rig, "m_L");
                    UnityEngine.Object.Destroy(made);
                    UnityEngine.Object.Destroy(edited);
                }
            }
            using (var clip = AnthroClip.Builtin("idle", character.Body))
            {
                Expect.Throws<ArgumentNullException>(() => clip.ToAnimationClip(null), "no rig");
                var path = "Assets/idle.anim";
                var saved = Editor.AnthroSave.SaveClip(clip, character.Rig, false, path);
                Expect.That(UnityEditor.AssetDatabase.Contains(saved) && !saved.Loops, "not saved");
                UnityEditor.AssetDatabase.DeleteAsset(path);
            }
            Scene.Destroy(character);
        }

        [Test(Description = "quaternions that change sign are baked without a jump")]
        public static void Signs()
        {
            var character = Scene.Character(3, 3);
            using (var walk = AnthroClip.Builtin("walk", character.Body))
            {
                var frames = walk.Bake();
                // The same rotations, every other frame negated.
                for (var i = 0; i < frames.Length; i++)
                {
                    var q = frames[i].rotation;
                    frames[i].rotation = i / walk.JointCount % 2 == 0 ? q : new Quaternion(-q.x, -q.y, -q.z, -q.w);
                }
                using (var flipped = AnthroClip.FromPoses(character.Body, "walk", walk.FramesPerSecond, frames))
                {
                    var made = flipped.ToAnimationClip(character.Rig);
                    Compare(made, walk, character.Rig, "l");
                    UnityEngine.Object.Destroy(made);
                }
            }
            Scene.Destroy(character);
        }

        [Test(Description = "a built-in clip follows its character to another body and continues at the same time")]
        public static void Rebound()
        {
            var character = Scene.Character(3, 3);
            var animator = character.gameObject.AddComponent<AnthroAnimator>();
            animator.Play("walk");
            animator.Advance(0.4f);
            var before = animator.Clip;
            character.Request.Set("height", 1.6);
            character.Generate();
            Expect.That(!ReferenceEquals(before, animator.Clip), "the clip of the body before");
            Expect.Near(0.4, animator.Time, 1e-6, "time");
            Expect.Throws<ObjectDisposedException>(() => before.Bake(), "it is not freed");
            using (var fresh = AnthroClip.Builtin("walk", character.Body))
            {
                var pose = new AnthroTransform[fresh.JointCount];
                fresh.Sample((double)0.4f, AnthroWrap.Loop, pose, true);
                var hips = Scene.WorldPosition(character.Rig.Find("pelvis"));
                var expected = pose[Scene.Joint(character, "pelvis")].translation;
                Expect.That((hips - expected).magnitude < 1e-5, "not in the pose of the clip at once: " + hips + ", " + expected);
            }
            // A clip of the caller's stays as it is.
            using (var mine = AnthroClip.Builtin("idle", character.Body))
            {
                animator.Play(mine);
                character.Generate();
                Expect.That(ReferenceEquals(mine, animator.Clip), "another clip");
                animator.Play((AnthroClip)null);
                Expect.That(mine.Bake().Length > 0, "it was freed");
            }
            // Playback continues after a domain reload.
            animator.Play("walk");
            animator.Advance(0.3f);
            Editor.AnthroReload.Release();
            Scene.Reload(character);
            Scene.Reload(animator);
            Expect.That(animator.Clip != null && animator.Clip.Name == "walk", "it does not play");
            Expect.Near(0.3, animator.Time, 1e-6, "time");
            animator.Advance(0.1f);
            Scene.Destroy(character);
            var bare = new GameObject("bare");
            bare.SetActive(false);
            var nobody = bare.AddComponent<AnthroAnimator>();
            Expect.Throws<InvalidOperationException>(() => nobody.Play("walk"), "no body");
            UnityEngine.Object.Destroy(bare);
        }
    }
}
