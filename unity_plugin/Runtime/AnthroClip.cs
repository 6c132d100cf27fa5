using System;
using Anthronet.Native;
using UnityEngine;

namespace Anthronet
{
    /// <summary>How a motion file comes onto a body. Zeros are the defaults.</summary>
    public struct AnthroRetarget
    {
        /// <summary>What the fingers do.</summary>
        public AnthroFingers fingers;
        /// <summary>Leaves joints beyond what people's joints do.</summary>
        public bool noLimits;
        /// <summary>Leaves feet where the motion puts them.</summary>
        public bool noFeet;
        /// <summary>Leaves out the way over the ground.</summary>
        public bool inPlace;
        /// <summary>Makes the end meet the beginning.</summary>
        public bool looped;
        /// <summary>Gives the way over the ground to the joint `Root` instead of the pelvis.</summary>
        public bool rootMotion;
        /// <summary>Frames per second; 0 keeps those of the file.</summary>
        public double framesPerSecond;
        /// <summary>Which joint of the file drives which of ours, as JSON; null to find all of them.</summary>
        public string mappingJson;
    }

    /// <summary>A motion of a body's joints. Immutable; may be sampled by many threads at once.</summary>
    public sealed unsafe class AnthroClip : IDisposable
    {
        readonly ClipHandle handle;

        AnthroClip(anthronet_clip* pointer)
        {
            handle = new ClipHandle(pointer);
            anthronet_clip_info info;
            info.struct_size = (uint)sizeof(anthronet_clip_info);
            anthronet_error error;
            Library.Check(NativeMethods.anthronet_clip_describe(pointer, &info, &error), &error);
            Name = Utf8.Text(info.name);
            FrameCount = (int)info.frame_count;
            JointCount = (int)info.joint_count;
            FramesPerSecond = info.frames_per_second;
            Duration = info.duration;
        }

        internal ClipHandle Handle
        {
            get { return handle; }
        }

        /// <summary>Its name.</summary>
        public string Name { get; private set; }

        /// <summary>Number of frames.</summary>
        public int FrameCount { get; private set; }

        /// <summary>Number of joints.</summary>
        public int JointCount { get; private set; }

        /// <summary>Frames per second.</summary>
        public double FramesPerSecond { get; private set; }

        /// <summary>From the first frame to the last, seconds.</summary>
        public double Duration { get; private set; }

        /// <summary>The names of the built-in clips.</summary>
        public static string[] BuiltinNames()
        {
            Library.Ensure();
            var names = new string[NativeMethods.anthronet_clip_builtin_count()];
            for (var i = 0u; i < names.Length; i++)
            {
                anthronet_text name;
                anthronet_error error;
                Library.Check(NativeMethods.anthronet_clip_builtin_name(i, &name, &error), &error);
                names[i] = Utf8.Text(name);
            }
            return names;
        }

        /// <summary>A built-in clip for a body, such as `walk`.</summary>
        /// <exception cref="AnthroException">There is none of that name.</exception>
        public static AnthroClip Builtin(string name, AnthroBody body)
        {
            ulong length;
            using (var held = new Held(Library.NotNull(body, "body").Handle))
            fixed (byte* data = Utf8.Bytes(name, "name", out length))
            {
                anthronet_clip* made;
                anthronet_error error;
                Library.Check(NativeMethods.anthronet_clip_builtin(
                    data, length, (anthronet_body*)held.Pointer, &made, &error), &error);
                return new AnthroClip(made);
            }
        }

        /// <summary>
        /// Reads the first clip of a motion file onto a body: .bvh, .fbx, .glb, .gltf, .npz (AMASS, SMPL-X), .usda, .usdc,
        /// .usdz. `AnthroMotion` does it in two steps, for files with many clips or for many bodies.
        /// </summary>
        /// <exception cref="AnthroException">The file is not such a one, or its joints are not found.</exception>
        public static AnthroClip Open(string path, AnthroBody body, AnthroRetarget options = default(AnthroRetarget))
        {
            using (var motion = AnthroMotion.Open(path))
            {
                return motion.Onto(body, 0, options);
            }
        }

        /// <summary>A clip of poses: frame by frame, every joint relative to its parent in Unity's space.</summary>
        public static AnthroClip Of(AnthroBody body, string name, double framesPerSecond, AnthroTransform[] frames)
        {
            ulong length;
            using (var held = new Held(Library.NotNull(body, "body").Handle))
            fixed (AnthroTransform* first = Library.NotNull(frames, "frames"))
            fixed (byte* data = Utf8.Bytes(name, "name", out length))
            {
                anthronet_clip* made;
                anthronet_error error;
                Library.Check(NativeMethods.anthronet_clip_new((anthronet_body*)held.Pointer, data, length,
                    framesPerSecond, NativeMethods.ANTHRONET_SPACE_UNITY, (anthronet_transform*)first,
                    (ulong)frames.LongLength, &made, &error), &error);
                return new AnthroClip(made);
            }
        }

        internal static AnthroClip Wrap(anthronet_clip* pointer)
        {
            return new AnthroClip(pointer);
        }

        /// <summary>
        /// The pose at a time in Unity's space, `JointCount` joints. Makes no garbage.
        /// </summary>
        /// <param name="seconds">The time.</param>
        /// <param name="wrap">What the clip is outside its duration.</param>
        /// <param name="into">Filled: relative to the parents, or to the character if `toModel`.</param>
        /// <param name="toModel">Relative to the character, as `AnthroSkinner` takes it.</param>
        public void Sample(double seconds, AnthroWrap wrap, AnthroTransform[] into, bool toModel = false)
        {
            fixed (AnthroTransform* first = Library.NotNull(into, "into"))
            {
                Sample(seconds, wrap, first, into.Length, toModel);
            }
        }

        internal void Sample(double seconds, AnthroWrap wrap, AnthroTransform* into, int count, bool toModel)
        {
            using (var held = new Held(handle))
            {
                anthronet_error error;
                Library.Check(NativeMethods.anthronet_clip_sample((anthronet_clip*)held.Pointer, seconds, (uint)wrap,
                    toModel ? NativeMethods.ANTHRONET_RELATIVE_TO_MODEL : NativeMethods.ANTHRONET_RELATIVE_TO_PARENT,
                    NativeMethods.ANTHRONET_SPACE_UNITY, (anthronet_transform*)into, (uint)count, &error), &error);
            }
        }

        /// <summary>All frames, one after the other, every joint relative to its parent in Unity's space.</summary>
        public AnthroTransform[] Bake()
        {
            var frames = new AnthroTransform[FrameCount * JointCount];
            using (var held = new Held(handle))
            fixed (AnthroTransform* first = frames)
            {
                anthronet_error error;
                Library.Check(NativeMethods.anthronet_clip_bake((anthronet_clip*)held.Pointer,
                    NativeMethods.ANTHRONET_RELATIVE_TO_PARENT, NativeMethods.ANTHRONET_SPACE_UNITY,
                    (anthronet_transform*)first, (ulong)frames.LongLength, &error), &error);
            }
            return frames;
        }

        /// <summary>
        /// As one of Unity's clips for the joints below a character's object, to be played by an `Animation` component: at
        /// run time Unity fills no others. The editor's `AnthroSave` makes one for an `Animator`. A key per frame for every
        /// rotation, and for the places of the root, the pelvis and whatever else moves; linear in between.
        /// </summary>
        /// <param name="rig">The joints of the character that it is for.</param>
        /// <exception cref="ArgumentException">The rig has other joints.</exception>
        public AnimationClip ToAnimationClip(AnthroRig rig)
        {
            var made = AnthroCurves.NewClip(this, true);
            foreach (var curve in AnthroCurves.Of(this, rig))
            {
                made.SetCurve(curve.path, typeof(Transform), curve.property, curve.keys);
            }
            made.EnsureQuaternionContinuity();
            return made;
        }

        /// <summary>At another rate.</summary>
        public AnthroClip Resampled(double framesPerSecond)
        {
            return Derive((clip, made, error) =>
                NativeMethods.anthronet_clip_resample(clip, framesPerSecond, made, error));
        }

        /// <summary>Without its way over the ground.</summary>
        public AnthroClip InPlace()
        {
            return Derive((clip, made, error) => NativeMethods.anthronet_clip_in_place(clip, made, error));
        }

        /// <summary>With its end going over into its beginning during the last `seconds`.</summary>
        public AnthroClip Looped(double seconds)
        {
            return Derive((clip, made, error) => NativeMethods.anthronet_clip_looped(clip, seconds, made, error));
        }

        /// <summary>Two clips of one body at once: `weight` 0 is this, 1 the other.</summary>
        public AnthroClip Blended(AnthroClip other, float weight)
        {
            using (var second = new Held(Library.NotNull(other, "other").handle))
            {
                var to = (anthronet_clip*)second.Pointer;
                return Derive((clip, made, error) => NativeMethods.anthronet_clip_blend(clip, to, weight, made, error));
            }
        }

        /// <summary>Two clips of one body one after the other, overlapping by `seconds`.</summary>
        public AnthroClip Then(AnthroClip other, double seconds)
        {
            using (var second = new Held(Library.NotNull(other, "other").handle))
            {
                var to = (anthronet_clip*)second.Pointer;
                return Derive((clip, made, error) => NativeMethods.anthronet_clip_crossfade(clip, to, seconds, made, error));
            }
        }

        delegate int DeriveCall(anthronet_clip* clip, anthronet_clip** made, anthronet_error* error);

        AnthroClip Derive(DeriveCall call)
        {
            using (var held = new Held(handle))
            {
                anthronet_clip* made;
                anthronet_error error;
                Library.Check(call((anthronet_clip*)held.Pointer, &made, &error), &error);
                return new AnthroClip(made);
            }
        }

        /// <summary>Frees it.</summary>
        public void Dispose()
        {
            handle.Dispose();
        }
    }
}
