using System;
using Anthronet.Native;

namespace Anthronet
{
    /// <summary>A part of a surface ready to be posed on the processor. Immutable; may be used by many threads.</summary>
    public sealed unsafe class AnthroSkinner : IDisposable
    {
        readonly SkinnerHandle handle;

        /// <summary>Makes a part of a surface ready; the surface is not needed afterwards.</summary>
        public AnthroSkinner(AnthroSurface surface, int part = 0)
        {
            using (var held = new Held(Library.NotNull(surface, "surface").Handle))
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

        /// <summary>Where it is, for `AnthroSkinJob.skinner`. Valid as long as this is not disposed of: keep it.</summary>
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

        /// <summary>Frees it.</summary>
        public void Dispose()
        {
            handle.Dispose();
        }
    }
}
