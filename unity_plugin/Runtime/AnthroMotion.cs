using System;
using Anthronet.Native;
using UnityEngine;

namespace Anthronet
{
    /// <summary>How a motion file is read. Default values leave everything to the file.</summary>
    public struct AnthroMotionOptions
    {
        /// <summary>The axis of the file that points up.</summary>
        public AnthroUpAxis up;
        /// <summary>Metres per unit of length, such as 0.01; 0 leaves it to the file.</summary>
        public double metresPerUnit;
        /// <summary>Frames were recorded at this rate, curves are sampled at it; 0 leaves it to the file.</summary>
        public double framesPerSecond;
        /// <summary>Which of several people in an .npz, from 1; 0 reads the first, and `ReportJson` warns.</summary>
        public int person;

        internal unsafe anthronet_motion_options Native()
        {
            return new anthronet_motion_options
            {
                struct_size = (uint)sizeof(anthronet_motion_options),
                up = (uint)up,
                metres_per_unit = metresPerUnit,
                frames_per_second = framesPerSecond,
                person = checked((uint)person),
            };
        }
    }

    /// <summary>A motion file with its own skeleton, before retargeting. Immutable; any thread may use it.</summary>
    public sealed unsafe class AnthroMotion : IDisposable
    {
        readonly MotionHandle handle;

        AnthroMotion(anthronet_motion* pointer)
        {
            handle = new MotionHandle(pointer);
        }

        /// <summary>Reads a motion file: .bvh, .fbx, .glb, .gltf, .vrm, .vrma, .npz (AMASS, SMPL-X), .usd, .usda, .usdc,
        /// .usdz.</summary>
        /// <exception cref="AnthroException">The file is not valid.</exception>
        public static AnthroMotion Open(string path, AnthroMotionOptions options = default(AnthroMotionOptions))
        {
            Library.Ensure();
            var read = options.Native();
            ulong length;
            fixed (byte* data = Utf8.Bytes(path, "path", out length))
            {
                anthronet_motion* made;
                anthronet_error error;
                Library.Check(NativeMethods.anthronet_motion_open_path(data, length, &read, &made, &error), &error);
                return new AnthroMotion(made);
            }
        }

        /// <summary>Reads a motion file from memory; the extension of `name` says the format.</summary>
        /// <exception cref="AnthroException">The bytes are not a valid motion file.</exception>
        public static AnthroMotion Open(byte[] bytes, string name, AnthroMotionOptions options = default(AnthroMotionOptions))
        {
            Library.NotNull(bytes, "bytes");
            Library.Ensure();
            var read = options.Native();
            ulong length;
            fixed (byte* text = Utf8.Bytes(name, "name", out length))
            fixed (byte* data = bytes.Length == 0 ? new byte[1] : bytes)
            {
                anthronet_motion* made;
                anthronet_error error;
                Library.Check(NativeMethods.anthronet_motion_open_memory(
                    data, (ulong)bytes.Length, text, length, &read, &made, &error), &error);
                return new AnthroMotion(made);
            }
        }

        /// <summary>Number of clips, at least one.</summary>
        public int ClipCount
        {
            get
            {
                return Library.Number(handle, (pointer, count, error) =>
                    NativeMethods.anthronet_motion_clip_count((anthronet_motion*)pointer, count, error));
            }
        }

        /// <summary>The name of a clip.</summary>
        public string ClipName(int clip)
        {
            var index = checked((uint)clip);
            return Library.Text(handle, (pointer, name, error) =>
                NativeMethods.anthronet_motion_clip_name((anthronet_motion*)pointer, index, name, error));
        }

        /// <summary>How the file was interpreted, as JSON.</summary>
        public string ReportJson
        {
            get
            {
                return Library.BytesText(handle, (pointer, bytes, error) =>
                    NativeMethods.anthronet_motion_report((anthronet_motion*)pointer, bytes, error));
            }
        }

        /// <summary>Retargets a clip to a body. Where the motion may be no person's, an animal's for example, the console says
        /// why.</summary>
        /// <exception cref="AnthroException">Joints of a humanoid were not found in the file, or the motion is more likely no
        /// person's (a confidence below 0.5), no joints are mapped and it is not forced.</exception>
        public AnthroClip Retarget(AnthroBody body, int clip = 0, AnthroRetargetOptions options = default(AnthroRetargetOptions))
        {
            ulong length;
            var mapping = Utf8.Bytes(options.mappingJson ?? string.Empty, "mappingJson", out length);
            using (var target = new Held(Library.NotNull(body, "body").Handle))
            using (var held = new Held(handle))
            fixed (byte* json = mapping)
            {
                var retarget = new anthronet_retarget_options();
                retarget.struct_size = (uint)sizeof(anthronet_retarget_options);
                retarget.fingers = (uint)options.fingers;
                retarget.no_limits = options.noLimits ? 1u : 0u;
                retarget.no_feet = options.noFeet ? 1u : 0u;
                retarget.in_place = options.inPlace ? 1u : 0u;
                retarget.looped = options.looped ? 1u : 0u;
                retarget.force = options.force ? 1u : 0u;
                retarget.root_motion = options.rootMotion ? 1u : 0u;
                retarget.frames_per_second = options.framesPerSecond;
                retarget.mapping_length = (uint)length;
                retarget.mapping_json = length == 0 ? null : json;
                anthronet_clip* made;
                anthronet_bytes* report;
                anthronet_error error;
                Library.Check(NativeMethods.anthronet_motion_retarget((anthronet_motion*)held.Pointer,
                    checked((uint)clip), (anthronet_body*)target.Pointer, &retarget, &made, &report, &error), &error);
                var retargeted = AnthroClip.Wrap(made, Utf8.TakeText(report));
                if (retargeted.Doubts.Length > 0)
                {
                    Debug.LogWarning("AnthroNet: " + retargeted.Name + ": this may be no person, or not a whole one: "
                        + string.Join("; ", retargeted.Doubts));
                }
                return retargeted;
            }
        }

        /// <summary>Frees the native memory. Clips made from the motion stay valid.</summary>
        public void Dispose()
        {
            handle.Dispose();
        }
    }
}
