using System;
using System.Runtime.InteropServices;
using Anthronet.Native;
using UnityEngine;

namespace Anthronet
{
    /// <summary>
    /// One surface to pose on the processor: pointers and numbers alone, so that Burst's code may hold it. Laid out as the
    /// library's. Positions and normals are packed vectors, or lie in one vertex buffer.
    /// </summary>
    [StructLayout(LayoutKind.Sequential)]
    public unsafe struct AnthroSkinJob
    {
        /// <summary>Bytes of this structure.</summary>
        public uint size;
        /// <summary>How.</summary>
        public AnthroSkinning method;
        /// <summary>`AnthroSkinner.Pointer`.</summary>
        public IntPtr skinner;
        /// <summary>The pose, every joint relative to the character: as `AnthroClip.Sample` gives it with `toModel`.
        /// </summary>
        public AnthroTransform* joints;
        /// <summary>Number of joints.</summary>
        public uint jointCount;
        /// <summary>Number of offsets: 0, or one per vertex.</summary>
        public uint offsetCount;
        /// <summary>Metres that are added to the bind positions before they are posed; null for none.</summary>
        public Vector3* offsets;
        /// <summary>Where the first position is written, metres.</summary>
        public void* positions;
        /// <summary>Bytes of that buffer.</summary>
        public ulong positionBytes;
        /// <summary>Bytes from position to position; 0 for packed.</summary>
        public ulong positionStride;
        /// <summary>Where the first unit normal is written; null for nowhere.</summary>
        public void* normals;
        /// <summary>Bytes of that buffer.</summary>
        public ulong normalBytes;
        /// <summary>Bytes from normal to normal; 0 for packed.</summary>
        public ulong normalStride;

        /// <summary>Into packed vectors.</summary>
        public AnthroSkinJob(IntPtr skinner, AnthroSkinning method, AnthroTransform* joints, int jointCount,
            Vector3* positions, Vector3* normals, int vertexCount)
        {
            this = default(AnthroSkinJob);
            size = (uint)sizeof(AnthroSkinJob);
            this.skinner = skinner;
            this.method = method;
            this.joints = joints;
            this.jointCount = (uint)jointCount;
            this.positions = positions;
            positionBytes = (ulong)vertexCount * (ulong)sizeof(Vector3);
            this.normals = normals;
            normalBytes = normals == null ? 0 : positionBytes;
        }
    }

    /// <summary>Skinning without objects of the collector: what Burst's code can call.</summary>
    public static unsafe class AnthroSkin
    {
        /// <summary>Poses the surfaces of jobs, on all cores, from whatever thread. Makes no garbage and throws nothing.
        /// </summary>
        /// <param name="jobs">The first of them. Buffers of different jobs do not overlap.</param>
        /// <param name="count">How many.</param>
        /// <returns>0 where it was done; else one of `AnthroError`, and nothing is written.</returns>
        public static int Run(AnthroSkinJob* jobs, int count)
        {
            return NativeMethods.anthronet_skin((anthronet_skin_job*)jobs, (uint)count, null);
        }
    }
}
