using System;
using Anthronet.Native;

namespace Anthronet
{
    /// <summary>
    /// A person in the bind pose (a T-pose) with the report of the solve. Immutable; any thread may use it.
    /// </summary>
    public sealed unsafe class AnthroBody : IDisposable
    {
        readonly BodyHandle handle;
        readonly anthronet_body_summary summary;

        internal AnthroBody(anthronet_body* pointer)
        {
            handle = new BodyHandle(pointer);
            anthronet_body_summary found;
            found.struct_size = (uint)sizeof(anthronet_body_summary);
            anthronet_error error;
            Library.Check(NativeMethods.anthronet_body_summarise(pointer, &found, &error), &error);
            summary = found;
        }

        internal BodyHandle Handle
        {
            get { return handle; }
        }

        /// <summary>Whether the native memory is freed.</summary>
        internal bool IsFreed
        {
            get { return handle.IsClosed; }
        }

        /// <summary>Female or male.</summary>
        public AnthroSex Sex
        {
            get { return (AnthroSex)summary.sex; }
        }

        /// <summary>The request's seed.</summary>
        public ulong Seed
        {
            get { return summary.seed; }
        }

        /// <summary>Kilograms.</summary>
        public double Mass
        {
            get { return summary.mass_kg; }
        }

        /// <summary>Cubic metres.</summary>
        public double Volume
        {
            get { return summary.volume_m3; }
        }

        /// <summary>Body mass index, kg/m².</summary>
        public double Bmi
        {
            get { return summary.bmi; }
        }

        /// <summary>Largest difference between a requested measure and the body's, metres.</summary>
        public double SolveResidual
        {
            get { return summary.solve_residual; }
        }

        /// <summary>Whether the exact solve reached its tolerance.</summary>
        public bool Converged
        {
            get { return summary.converged != 0; }
        }

        /// <summary>Number of warnings in the report.</summary>
        public int WarningCount
        {
            get { return (int)summary.warning_count; }
        }

        /// <summary>Number of joints.</summary>
        public int JointCount
        {
            get { return (int)summary.joint_count; }
        }

        /// <summary>Writes the report of all measures, in the order of `AnthroMeasures.Names`.</summary>
        public void Measures(AnthroMeasureReport[] results)
        {
            using (var held = new Held(handle))
            fixed (AnthroMeasureReport* first = Library.NotNull(results, "results"))
            {
                anthronet_error error;
                Library.Check(NativeMethods.anthronet_body_measures((anthronet_body*)held.Pointer,
                    (anthronet_measure_report*)first, (uint)results.Length, &error), &error);
            }
        }

        /// <summary>The report of all measures, in the order of `AnthroMeasures.Names`.</summary>
        public AnthroMeasureReport[] Measures()
        {
            var reports = new AnthroMeasureReport[AnthroMeasures.Count];
            Measures(reports);
            return reports;
        }

        /// <summary>The complete report as JSON, with warnings and conflicts.</summary>
        public string ReportJson
        {
            get
            {
                return Library.BytesText(handle, (pointer, bytes, error) =>
                    NativeMethods.anthronet_body_report((anthronet_body*)pointer, bytes, error));
            }
        }

        /// <summary>Writes the latent values of the body, `AnthroModel.LatentSize` of them.</summary>
        public void Latent(double[] results)
        {
            using (var held = new Held(handle))
            fixed (double* first = Library.NotNull(results, "results"))
            {
                anthronet_error error;
                Library.Check(NativeMethods.anthronet_body_latent(
                    (anthronet_body*)held.Pointer, first, (uint)results.Length, &error), &error);
            }
        }

        /// <summary>Writes the joints in the bind pose, in Unity's space, parents first, `JointCount` of them.</summary>
        public void Joints(AnthroJoint[] results)
        {
            using (var held = new Held(handle))
            fixed (AnthroJoint* first = Library.NotNull(results, "results"))
            {
                anthronet_error error;
                Library.Check(NativeMethods.anthronet_body_joints((anthronet_body*)held.Pointer,
                    NativeMethods.ANTHRONET_SPACE_UNITY, (anthronet_joint*)first, (uint)results.Length, &error), &error);
            }
        }

        /// <summary>The joints in the bind pose, in Unity's space, parents first.</summary>
        public AnthroJoint[] Joints()
        {
            var joints = new AnthroJoint[JointCount];
            Joints(joints);
            return joints;
        }

        /// <summary>The name of a joint in the rig, such as `upperarm_l`. Names are unique.</summary>
        public string JointName(int joint)
        {
            var index = checked((uint)joint);
            return Library.Text(handle, (pointer, name, error) => NativeMethods.anthronet_body_joint_name(
                (anthronet_body*)pointer, index, NativeMethods.ANTHRONET_NAMES_NATIVE, name, error));
        }

        /// <summary>Exports a file in the format of its extension: .glb, .gltf, .vrm, .usda, .usdc, .usdz or .obj. The
        /// file is written completely or not at all.</summary>
        /// <param name="path">The file; an existing one is replaced.</param>
        /// <param name="lod">Level of detail, 0 to 3.</param>
        /// <param name="clips">Animation clips to include; their names must differ.</param>
        public void Save(string path, int lod = 0, params AnthroClip[] clips)
        {
            ulong length;
            var bytes = Utf8.Bytes(path, "path", out length);
            Export(lod, clips, options =>
            {
                using (var held = new Held(handle))
                fixed (byte* data = bytes)
                {
                    anthronet_error error;
                    Library.Check(NativeMethods.anthronet_export_path((anthronet_body*)held.Pointer,
                        (anthronet_export_options*)options, data, length, &error), &error);
                }
            });
        }

        /// <summary>The bytes of the file that `Save` writes; `format` is its extension without the dot.</summary>
        public byte[] ToBytes(string format, int lod = 0, params AnthroClip[] clips)
        {
            ulong length;
            var bytes = Utf8.Bytes(format, "format", out length);
            byte[] result = null;
            Export(lod, clips, options =>
            {
                using (var held = new Held(handle))
                fixed (byte* data = bytes)
                {
                    anthronet_bytes* made;
                    anthronet_error error;
                    Library.Check(NativeMethods.anthronet_export_memory((anthronet_body*)held.Pointer,
                        (anthronet_export_options*)options, data, length, &made, &error), &error);
                    result = Utf8.TakeBytes(made);
                }
            });
            return result;
        }

        static void Export(int lod, AnthroClip[] clips, Action<IntPtr> write)
        {
            // One extra entry: `fixed` gives null for an empty array.
            var pointers = new IntPtr[Library.NotNull(clips, "clips").Length + 1];
            var held = new Held[clips.Length];
            try
            {
                for (var i = 0; i < clips.Length; i++)
                {
                    held[i] = new Held(Library.NotNull(clips[i], "clips").Handle);
                    pointers[i] = (IntPtr)held[i].Pointer;
                }
                fixed (IntPtr* first = pointers)
                {
                    var options = new anthronet_export_options();
                    options.struct_size = (uint)sizeof(anthronet_export_options);
                    options.lod = checked((uint)lod);
                    options.clip_count = (uint)clips.Length;
                    options.clips = (anthronet_clip**)first;
                    write((IntPtr)(&options));
                }
            }
            finally
            {
                for (var i = 0; i < held.Length; i++)
                {
                    held[i].Dispose();
                }
            }
        }

        /// <summary>Frees the native memory. Meshes, clips and exports made from the body stay valid.</summary>
        public void Dispose()
        {
            handle.Dispose();
        }
    }
}
