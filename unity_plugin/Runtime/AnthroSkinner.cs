using System;
using Anthronet.Native;

namespace Anthronet
{
    /// <summary>A part of a mesh prepared for skinning on the CPU. Immutable; any number of threads may use
    /// it.</summary>
    public sealed unsafe class AnthroSkinner : IDisposable
    {
        readonly SkinnerHandle handle;

        /// <summary>Prepares a part of a mesh, which may be disposed afterwards.</summary>
        public AnthroSkinner(AnthroMesh mesh, int part = 0)
        {
            using (var held = new Held(Library.NotNull(mesh, "mesh").Handle))
            {
                anthronet_skinner* made;
                anthronet_error error;
                Library.Check(NativeMethods.anthronet_skinner_new(
                    (anthronet_mesh*)held.Pointer, checked((uint)part), &made, &error), &error);
                handle = new SkinnerHandle(made);
                uint count;
                Library.Check(NativeMethods.anthronet_skinner_vertex_count(made, &count, &error), &error);
                VertexCount = (int)count;
            }
        }

        /// <summary>The native pointer, for `AnthroSkinJob.skinner`. Valid until this object is disposed: keep a
        /// reference.</summary>
        public IntPtr Pointer
        {
            get { return handle.IsClosed ? IntPtr.Zero : handle.DangerousGetHandle(); }
        }

        internal SkinnerHandle Handle
        {
            get { return handle; }
        }

        /// <summary>Number of vertices.</summary>
        public int VertexCount { get; private set; }

        /// <summary>Frees the native memory.</summary>
        public void Dispose()
        {
            handle.Dispose();
        }
    }
}
