using System;
using Anthronet.Native;

namespace Anthronet
{
    /// <summary>
    /// Native memory that sampling and skinning work in, used again by the next call: it saves allocations and does not
    /// change results. Make one per character or per thread; only one call at a time may use it.
    /// </summary>
    public sealed unsafe class AnthroContext : IDisposable
    {
        readonly ContextHandle handle;

        /// <summary>Makes an empty context; it grows as calls need.</summary>
        public AnthroContext()
        {
            Library.Ensure();
            anthronet_context* made;
            anthronet_error error;
            Library.Check(NativeMethods.anthronet_context_new(&made, &error), &error);
            handle = new ContextHandle(made);
        }

        /// <summary>The native pointer, for `AnthroSkin.Run`. Valid until this object is disposed: keep a
        /// reference.</summary>
        public IntPtr Pointer
        {
            get { return handle.IsClosed ? IntPtr.Zero : handle.DangerousGetHandle(); }
        }

        /// <summary>Keeps a context from being freed during a native call; null is allowed.</summary>
        internal static Held Hold(AnthroContext context)
        {
            return context == null ? default(Held) : new Held(context.handle);
        }

        /// <summary>Frees the native memory.</summary>
        public void Dispose()
        {
            handle.Dispose();
        }
    }
}
