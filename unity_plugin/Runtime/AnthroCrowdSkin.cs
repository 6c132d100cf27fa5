using System;
using Anthronet.Native;
using Unity.Collections;
using Unity.Collections.LowLevel.Unsafe;
using UnityEngine;

namespace Anthronet
{
    /// <summary>
    /// Skins the surfaces of many characters on the CPU in one call, on all cores, into native arrays of positions and
    /// normals. `Run` allocates no managed memory. One thread at a time.
    /// </summary>
    public sealed unsafe class AnthroCrowdSkin : IDisposable
    {
        readonly AnthroSkinner[] skinners;
        readonly Held[] held;
        readonly AnthroSkinJob[] jobs;
        NativeArray<AnthroTransform> poses;
        NativeArray<Vector3> positions;
        NativeArray<Vector3> normals;
        readonly AnthroContext context;
        readonly int[] offsets;
        readonly int jointCount;

        /// <summary>Allocates the arrays for a number of characters.</summary>
        /// <param name="skinners">One per character; characters may share one. They stay alive as long as this
        /// object.</param>
        /// <param name="jointCount">Joints per pose: `AnthroClip.JointCount`.</param>
        /// <param name="method">The skinning method.</param>
        public AnthroCrowdSkin(
            AnthroSkinner[] skinners, int jointCount, AnthroSkinMethod method = AnthroSkinMethod.Linear)
        {
            this.skinners = (AnthroSkinner[])Library.NotNull(skinners, "skinners").Clone();
            this.jointCount = jointCount;
            offsets = new int[skinners.Length + 1];
            for (var i = 0; i < skinners.Length; i++)
            {
                offsets[i + 1] = checked(offsets[i] + Library.NotNull(skinners[i], "skinners").VertexCount);
            }
            var vertices = offsets[skinners.Length];
            held = new Held[skinners.Length];
            jobs = new AnthroSkinJob[skinners.Length];
            try
            {
                context = new AnthroContext();
                for (var i = 0; i < skinners.Length; i++)
                {
                    held[i] = new Held(skinners[i].Handle);
                }
                poses = new NativeArray<AnthroTransform>(checked(skinners.Length * jointCount), Allocator.Persistent);
                positions = new NativeArray<Vector3>(vertices, Allocator.Persistent);
                normals = new NativeArray<Vector3>(vertices, Allocator.Persistent);
                FillJobs(method);
            }
            catch
            {
                Dispose();
                throw;
            }
            AnthroAlive.Add(this);
        }

        void FillJobs(AnthroSkinMethod method)
        {
            var firstPose = (AnthroTransform*)NativeArrayUnsafeUtility.GetUnsafePtr(poses);
            var firstPosition = (Vector3*)NativeArrayUnsafeUtility.GetUnsafePtr(positions);
            var firstNormal = (Vector3*)NativeArrayUnsafeUtility.GetUnsafePtr(normals);
            for (var i = 0; i < jobs.Length; i++)
            {
                jobs[i] = new AnthroSkinJob(
                    (IntPtr)held[i].Pointer, method, firstPose + i * jointCount, jointCount, firstPosition + offsets[i],
                    firstNormal + offsets[i], skinners[i].VertexCount);
            }
        }

        /// <summary>Number of characters.</summary>
        public int Count
        {
            get { return skinners.Length; }
        }

        /// <summary>Skinned positions of all characters, one after the other, metres, each in its character's
        /// space.</summary>
        public NativeArray<Vector3> Positions
        {
            get { return positions; }
        }

        /// <summary>Skinned unit normals of all characters, one after the other.</summary>
        public NativeArray<Vector3> Normals
        {
            get { return normals; }
        }

        /// <summary>Index of a character's first vertex; for `Count`, the total number of vertices.</summary>
        public int FirstVertex(int character)
        {
            return offsets[character];
        }

        /// <summary>Sets the pose of a character from a clip. Allocates no managed memory.</summary>
        public void Pose(int character, AnthroClip clip, double seconds, AnthroWrap wrap)
        {
            ThrowIfDisposed();
            if (character < 0 || character >= skinners.Length)
            {
                throw new ArgumentOutOfRangeException("character");
            }
            var first = (AnthroTransform*)NativeArrayUnsafeUtility.GetUnsafePtr(poses) + character * jointCount;
            Library.NotNull(clip, "clip").Sample(seconds, wrap, first, jointCount, true, context);
        }

        /// <summary>Skins all surfaces. Allocates no managed memory.</summary>
        public void Run()
        {
            ThrowIfDisposed();
            using (var work = AnthroContext.Hold(context))
            fixed (AnthroSkinJob* first = jobs)
            {
                anthronet_error error;
                Library.Check(NativeMethods.anthronet_skin((anthronet_context*)work.Pointer, (anthronet_skin_job*)first,
                    (uint)jobs.Length, &error), &error);
            }
        }

        /// <summary>A copy of what `Run` passes to `AnthroSkin.Run`, for a job of your own: pin it, and keep this object
        /// alive until the job is complete.</summary>
        public AnthroSkinJob[] Jobs
        {
            get
            {
                ThrowIfDisposed();
                return (AnthroSkinJob[])jobs.Clone();
            }
        }

        void ThrowIfDisposed()
        {
            if (!positions.IsCreated)
            {
                throw new ObjectDisposedException("AnthroCrowdSkin");
            }
        }

        /// <summary>Frees the native arrays; arrays obtained from `Positions` and `Normals` become invalid.</summary>
        public void Dispose()
        {
            Release();
            GC.SuppressFinalize(this);
        }

        // Native arrays have no finaliser of their own.
        ~AnthroCrowdSkin()
        {
            Release();
        }

        void Release()
        {
            for (var i = 0; held != null && i < held.Length; i++)
            {
                held[i].Dispose();
            }
            if (context != null)
            {
                context.Dispose();
            }
            Free(ref poses);
            Free(ref positions);
            Free(ref normals);
        }

        static void Free<T>(ref NativeArray<T> array) where T : struct
        {
            if (array.IsCreated)
            {
                array.Dispose();
            }
        }
    }
}
