using System;
using System.Runtime.InteropServices;

namespace Anthronet
{
    /// <summary>What the render thread is to pose. It and all that it points to stay until that was done.</summary>
    [StructLayout(LayoutKind.Sequential)]
    public unsafe struct AnthroSkinBatch
    {
        /// <summary>The first of the surfaces.</summary>
        public AnthroSkinJob* jobs;
        /// <summary>How many.</summary>
        public uint count;
        /// <summary>Becomes what `AnthroSkin.Run` returns.</summary>
        public int status;
    }

    /// <summary>
    /// Skinning on Unity's render thread: the library as a native rendering plugin. Give `Callback`, `Skin` and a pointer to
    /// an `AnthroSkinBatch` to `CommandBuffer.IssuePluginEventAndData`.
    /// </summary>
    public static class AnthroRenderEvent
    {
#if (UNITY_IOS || UNITY_WEBGL) && !UNITY_EDITOR
        const string Dll = "__Internal";
#else
        const string Dll = "anthronet";
#endif

        /// <summary>The event that poses a batch.</summary>
        public const int Skin = 1;

        /// <summary>The function that the render thread calls; zero where the library was built without
        /// `Plugins~/UnityPlugin.c`.</summary>
        public static IntPtr Callback
        {
            get { return Ask(anthronet_unity_render_event); }
        }

        /// <summary>Unity's native interfaces, which Unity handed to the library as it loaded it; zero where it did not.
        /// </summary>
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
