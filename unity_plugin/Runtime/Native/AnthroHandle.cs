using System;
using System.Runtime.InteropServices;

namespace Anthronet.Native
{
    /// <summary>
    /// A native object, freed once: by `Dispose`, or by the finaliser if nobody disposed it. Native objects do not depend
    /// on those that they were made from, so the order does not matter.
    /// </summary>
    internal abstract class AnthroHandle : SafeHandle
    {
        protected AnthroHandle(IntPtr pointer) : base(IntPtr.Zero, true)
        {
            SetHandle(pointer);
            AnthroAlive.Add(this);
        }

        public override bool IsInvalid
        {
            get { return handle == IntPtr.Zero; }
        }
    }

    /// <summary>Keeps a handle from being freed during a native call. A struct, to allocate no managed memory; its default
    /// holds nothing and has a null pointer.</summary>
    internal unsafe struct Held : IDisposable
    {
        readonly AnthroHandle handle;
        bool held;

        /// <exception cref="ArgumentNullException">The handle is null.</exception>
        /// <exception cref="ObjectDisposedException">The handle is freed.</exception>
        public Held(AnthroHandle handle)
        {
            if (handle == null)
            {
                throw new ArgumentNullException("handle");
            }
            this.handle = handle;
            held = false;
            handle.DangerousAddRef(ref held);
        }

        public void* Pointer
        {
            get { return handle == null ? null : (void*)handle.DangerousGetHandle(); }
        }

        public void Dispose()
        {
            if (held)
            {
                held = false;
                handle.DangerousRelease();
            }
        }
    }

    internal sealed unsafe class BytesHandle : AnthroHandle
    {
        public BytesHandle(anthronet_bytes* pointer) : base((IntPtr)pointer) { }

        protected override bool ReleaseHandle()
        {
            NativeMethods.anthronet_bytes_free((anthronet_bytes*)handle);
            return true;
        }
    }

    internal sealed unsafe class ModelHandle : AnthroHandle
    {
        public ModelHandle(anthronet_model* pointer) : base((IntPtr)pointer) { }

        protected override bool ReleaseHandle()
        {
            NativeMethods.anthronet_model_free((anthronet_model*)handle);
            return true;
        }
    }

    internal sealed unsafe class RequestHandle : AnthroHandle
    {
        public RequestHandle(anthronet_request* pointer) : base((IntPtr)pointer) { }

        protected override bool ReleaseHandle()
        {
            NativeMethods.anthronet_request_free((anthronet_request*)handle);
            return true;
        }
    }

    internal sealed unsafe class BodyHandle : AnthroHandle
    {
        public BodyHandle(anthronet_body* pointer) : base((IntPtr)pointer) { }

        protected override bool ReleaseHandle()
        {
            NativeMethods.anthronet_body_free((anthronet_body*)handle);
            return true;
        }
    }

    internal sealed unsafe class BodyJobHandle : AnthroHandle
    {
        public BodyJobHandle(anthronet_job* pointer) : base((IntPtr)pointer) { }

        protected override bool ReleaseHandle()
        {
            NativeMethods.anthronet_job_free((anthronet_job*)handle);
            return true;
        }
    }

    internal sealed unsafe class MeshHandle : AnthroHandle
    {
        public MeshHandle(anthronet_mesh* pointer) : base((IntPtr)pointer) { }

        protected override bool ReleaseHandle()
        {
            NativeMethods.anthronet_mesh_free((anthronet_mesh*)handle);
            return true;
        }
    }

    internal sealed unsafe class ClipHandle : AnthroHandle
    {
        public ClipHandle(anthronet_clip* pointer) : base((IntPtr)pointer) { }

        protected override bool ReleaseHandle()
        {
            NativeMethods.anthronet_clip_free((anthronet_clip*)handle);
            return true;
        }
    }

    internal sealed unsafe class MotionHandle : AnthroHandle
    {
        public MotionHandle(anthronet_motion* pointer) : base((IntPtr)pointer) { }

        protected override bool ReleaseHandle()
        {
            NativeMethods.anthronet_motion_free((anthronet_motion*)handle);
            return true;
        }
    }

    internal sealed unsafe class SkinnerHandle : AnthroHandle
    {
        public SkinnerHandle(anthronet_skinner* pointer) : base((IntPtr)pointer) { }

        protected override bool ReleaseHandle()
        {
            NativeMethods.anthronet_skinner_free((anthronet_skinner*)handle);
            return true;
        }
    }

    internal sealed unsafe class ContextHandle : AnthroHandle
    {
        public ContextHandle(anthronet_context* pointer) : base((IntPtr)pointer) { }

        protected override bool ReleaseHandle()
        {
            NativeMethods.anthronet_context_free((anthronet_context*)handle);
            return true;
        }
    }

    /// <summary>Native memory allocated by the package itself.</summary>
    internal sealed unsafe class MemoryHandle : AnthroHandle
    {
        public MemoryHandle(long bytes) : base(Marshal.AllocHGlobal(new IntPtr(bytes))) { }

        public byte* Pointer
        {
            get { return (byte*)handle; }
        }

        protected override bool ReleaseHandle()
        {
            Marshal.FreeHGlobal(handle);
            return true;
        }
    }
}
