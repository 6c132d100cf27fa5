using System;
using System.Runtime.InteropServices;
using Anthronet.Native;
using UnityEngine;

namespace Anthronet
{
    /// <summary>
    /// One surface to skin on the CPU: only pointers and numbers, so Burst code may hold it. Has the memory layout of the
    /// native structure. Positions and normals are separate arrays or interleaved in one vertex buffer.
    /// </summary>
    [StructLayout(LayoutKind.Sequential)]
    public unsafe struct AnthroSkinJob
    {
        /// <summary>Size of this structure in bytes.</summary>
        public uint structSize;
        /// <summary>The skinning method.</summary>
        public AnthroSkinMethod method;
        /// <summary>`AnthroSkinner.Pointer`.</summary>
        public IntPtr skinner;
        /// <summary>The pose, every joint relative to the character: `AnthroClip.Sample` with `toModel`.</summary>
        public AnthroTransform* joints;
        /// <summary>Number of joints.</summary>
        public uint jointCount;
        /// <summary>Number of offsets: 0, or the number of vertices.</summary>
        public uint offsetCount;
        /// <summary>Added to the bind-pose positions before skinning, metres; null for none.</summary>
        public Vector3* offsets;
        /// <summary>Receives the positions, metres.</summary>
        public void* positions;
        /// <summary>Size of the position buffer in bytes.</summary>
        public ulong positionBytes;
        /// <summary>Bytes between consecutive positions; 0 if tightly packed.</summary>
        public ulong positionStride;
        /// <summary>Receives the unit normals; null to skip them.</summary>
        public void* normals;
        /// <summary>Size of the normal buffer in bytes.</summary>
        public ulong normalBytes;
        /// <summary>Bytes between consecutive normals; 0 if tightly packed.</summary>
        public ulong normalStride;

        /// <summary>A job that writes tightly packed arrays.</summary>
        public AnthroSkinJob(IntPtr skinner, AnthroSkinMethod method, AnthroTransform* joints, int jointCount,
            Vector3* positions, Vector3* normals, int vertexCount)
        {
            this = default(AnthroSkinJob);
            structSize = (uint)sizeof(AnthroSkinJob);
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

    /// <summary>Skinning without managed objects, callable from Burst.</summary>
    public static unsafe class AnthroSkin
    {
        /// <summary>Skins the surfaces of jobs on all cores; callable from any thread. Allocates no managed memory, never
        /// throws.</summary>
        /// <param name="context">`AnthroContext.Pointer`, or zero. Only one call at a time may use a context.</param>
        /// <param name="jobs">The first job. Buffers of different jobs must not overlap.</param>
        /// <param name="count">Number of jobs.</param>
        /// <returns>0 on success; otherwise an `AnthroError`, and nothing is written.</returns>
        public static int Run(IntPtr context, AnthroSkinJob* jobs, int count)
        {
            return NativeMethods.anthronet_skin(
                (anthronet_context*)context, (anthronet_skin_job*)jobs, (uint)count, null);
        }
    }
}
