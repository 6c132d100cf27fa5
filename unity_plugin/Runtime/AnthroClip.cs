using System;
using Anthronet.Native;
using UnityEngine;

namespace Anthronet
{
    /// <summary>How a motion is retargeted to a body. Default values are the recommended ones.</summary>
    public struct AnthroRetargetOptions
    {
        /// <summary>Finger motion.</summary>
        public AnthroFingers fingers;
        /// <summary>Does not keep joints within anatomical limits.</summary>
        public bool noLimits;
        /// <summary>Does not correct feet that slide or go below the floor.</summary>
        public bool noFeet;
        /// <summary>Removes root motion: the character stays in place.</summary>
        public bool inPlace;
        /// <summary>Blends the end into the start, so that the clip loops.</summary>
        public bool looped;
        /// <summary>Puts root motion on the joint `Root` instead of the pelvis.</summary>
        public bool rootMotion;
        /// <summary>Frames per second of the clip; 0 keeps the file's.</summary>
        public double framesPerSecond;
        /// <summary>Which joint of the file drives which joint of the rig, as JSON; null maps all of them
        /// automatically.</summary>
        public string mappingJson;
        /// <summary>Accepts a motion that seems to be no person's, or in which nobody stands.</summary>
        public bool force;
    }

    /// <summary>An animation clip for a body's joints. Immutable; any number of threads may sample it.</summary>
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

        /// <summary>Time from the first frame to the last, seconds.</summary>
        public double Duration { get; private set; }

        /// <summary>How the clip was retargeted, as JSON: which joint drives which, how sure it is that the motion is a person's
        /// (`confidence`), errors of directions, limits and feet. Null for other clips.</summary>
        public string ReportJson { get; private set; }

        /// <summary>Why the motion may be no person's, such as a limb that it lacks; mostly empty.</summary>
        public string[] Doubts { get; private set; } = new string[0];

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

        /// <summary>Makes a built-in clip, such as `walk`, for a body.</summary>
        /// <exception cref="AnthroException">There is no built-in clip of this name.</exception>
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
        /// Reads the first clip of a motion file and retargets it to a body: .bvh, .fbx, .glb, .gltf, .vrm,
        /// .vrma, .npz (AMASS, SMPL-X), .usd, .usda, .usdc, .usdz. For files with several clips or people, or for several bodies, use
        /// `AnthroMotion`.
        /// </summary>
        /// <exception cref="AnthroException">The file is not valid, or joints of a humanoid were not found in
        /// it, or it seems to be no person's.</exception>
        public static AnthroClip Open(string path, AnthroBody body, AnthroRetargetOptions options = default(AnthroRetargetOptions))
        {
            using (var motion = AnthroMotion.Open(path))
            {
                return motion.Retarget(body, 0, options);
            }
        }

        /// <summary>Makes a clip of poses: all joints of each frame, relative to their parents, in Unity's
        /// space.</summary>
        public static AnthroClip FromPoses(AnthroBody body, string name, double framesPerSecond, AnthroTransform[] frames)
        {
            ulong length;
            using (var held = new Held(Library.NotNull(body, "body").Handle))
            fixed (AnthroTransform* first = Library.NotNull(frames, "frames"))
            fixed (byte* data = Utf8.Bytes(name, "name", out length))
            {
                anthronet_clip* made;
                anthronet_error error;
                Library.Check(NativeMethods.anthronet_clip_from_poses((anthronet_body*)held.Pointer, data, length,
                    framesPerSecond, NativeMethods.ANTHRONET_SPACE_UNITY, (anthronet_transform*)first,
                    (ulong)frames.LongLength, &made, &error), &error);
                return new AnthroClip(made);
            }
        }

        internal static AnthroClip Wrap(anthronet_clip* pointer, string report)
        {
            return new AnthroClip(pointer) { ReportJson = report, Doubts = new AnthroJson(report).Texts("doubts") };
        }

        /// <summary>
        /// Samples the pose of `JointCount` joints in Unity's space. Allocates no managed memory.
        /// </summary>
        /// <param name="seconds">Time from the start of the clip.</param>
        /// <param name="wrap">What happens outside the clip's duration.</param>
        /// <param name="results">Receives the transforms: relative to the parents, or to the character if
        /// `toModel`.</param>
        /// <param name="toModel">Transforms relative to the character, as `AnthroSkinner` needs them.</param>
        /// <param name="context">Saves native allocations if clips are sampled often; null for none.</param>
        public void Sample(double seconds, AnthroWrap wrap, AnthroTransform[] results, bool toModel = false,
            AnthroContext context = null)
        {
            fixed (AnthroTransform* first = Library.NotNull(results, "results"))
            {
                Sample(seconds, wrap, first, results.Length, toModel, context);
            }
        }

        internal void Sample(double seconds, AnthroWrap wrap, AnthroTransform* results, int count, bool toModel,
            AnthroContext context)
        {
            using (var held = new Held(handle))
            using (var work = AnthroContext.Hold(context))
            {
                anthronet_error error;
                Library.Check(NativeMethods.anthronet_clip_sample((anthronet_clip*)held.Pointer,
                    (anthronet_context*)work.Pointer, seconds, (uint)wrap,
                    toModel ? NativeMethods.ANTHRONET_RELATIVE_TO_MODEL : NativeMethods.ANTHRONET_RELATIVE_TO_PARENT,
                    NativeMethods.ANTHRONET_SPACE_UNITY, (anthronet_transform*)results, (uint)count, &error), &error);
            }
        }

        /// <summary>All frames one after the other, every joint relative to its parent, in Unity's space.</summary>
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
        /// Converts the clip to a legacy `AnimationClip` for an `Animation` component on the character: at run time Unity
        /// can only fill legacy clips. For an `Animator`, use the editor's `AnthroSave`. One key per frame: rotations of
        /// all joints, positions of the root, the pelvis and other moving joints, with linear interpolation.
        /// </summary>
        /// <param name="rig">The skeleton of the character.</param>
        /// <exception cref="ArgumentException">The rig has a different number of joints.</exception>
        public AnimationClip ToAnimationClip(AnthroRig rig)
        {
            var made = AnthroCurves.NewClip(this, true);
            foreach (var curve in AnthroCurves.FromClip(this, rig))
            {
                made.SetCurve(curve.path, typeof(Transform), curve.property, curve.keys);
            }
            made.EnsureQuaternionContinuity();
            return made;
        }

        /// <summary>The clip at another frame rate.</summary>
        public AnthroClip Resample(double framesPerSecond)
        {
            return Derive((clip, made, error) =>
                NativeMethods.anthronet_clip_resample(clip, framesPerSecond, made, error));
        }

        /// <summary>The clip without root motion.</summary>
        public AnthroClip InPlace()
        {
            return Derive((clip, made, error) => NativeMethods.anthronet_clip_in_place(clip, made, error));
        }

        /// <summary>The clip as a loop: its end blends into its start over the last `seconds`.</summary>
        public AnthroClip Looped(double seconds)
        {
            return Derive((clip, made, error) => NativeMethods.anthronet_clip_looped(clip, seconds, made, error));
        }

        /// <summary>A blend of two clips of the same body: `weight` 0 is this clip, 1 the other.</summary>
        public AnthroClip Blend(AnthroClip other, float weight)
        {
            using (var second = new Held(Library.NotNull(other, "other").handle))
            {
                var to = (anthronet_clip*)second.Pointer;
                return Derive((clip, made, error) => NativeMethods.anthronet_clip_blend(clip, to, weight, made, error));
            }
        }

        /// <summary>This clip followed by another of the same body, cross-faded over `seconds`.</summary>
        public AnthroClip Crossfade(AnthroClip other, double seconds)
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

        /// <summary>Frees the native memory.</summary>
        public void Dispose()
        {
            handle.Dispose();
        }
    }
}
