using System;
using System.Runtime.InteropServices;

namespace Anthronet
{
    /// <summary>What the render thread has to skin. It and everything it points to must stay valid until that is
    /// done.</summary>
    [StructLayout(LayoutKind.Sequential)]
    public unsafe struct AnthroSkinBatch
    {
        /// <summary>`AnthroContext.Pointer` of a context that nothing else uses until the event is done, or
        /// zero.</summary>
        public IntPtr context;
        /// <summary>The first job.</summary>
        public AnthroSkinJob* jobs;
        /// <summary>Number of jobs.</summary>
        public uint count;
        /// <summary>Receives the result of `AnthroSkin.Run`.</summary>
        public int status;
    }

    /// <summary>
    /// Skinning on Unity's render thread, with the library as a native rendering plugin. Pass `Callback`, `Skin` and a
    /// pointer to an `AnthroSkinBatch` to `CommandBuffer.IssuePluginEventAndData`.
    /// </summary>
    public static class AnthroRenderEvent
    {
#if (UNITY_IOS || UNITY_WEBGL) && !UNITY_EDITOR
        const string Dll = "__Internal";
#else
        const string Dll = "anthronet";
#endif

        /// <summary>The event that skins a batch.</summary>
        public const int Skin = 1;

        /// <summary>The function that the render thread calls; zero if the library was built without
        /// `Plugins~/UnityPlugin.c`.</summary>
        public static IntPtr Callback
        {
            get { return Ask(anthronet_unity_render_event); }
        }

        /// <summary>Unity's `IUnityInterfaces`, passed to the library when Unity loaded it; zero if Unity did
        /// not.</summary>
        public static IntPtr Interfaces
        {
            get { return Ask(anthronet_unity_interfaces); }
        }

        static IntPtr Ask(Func<IntPtr> function)
        {
            Native.Library.Ensure();
            try
            {
                return function();
            }
            catch (EntryPointNotFoundException)
            {
                return IntPtr.Zero;
            }
        }

        [DllImport(Dll, CallingConvention = CallingConvention.Cdecl, ExactSpelling = true)]
        static extern IntPtr anthronet_unity_render_event();

        [DllImport(Dll, CallingConvention = CallingConvention.Cdecl, ExactSpelling = true)]
        static extern IntPtr anthronet_unity_interfaces();
    }
}
