using System;

namespace Anthronet.Native
{
    /// <summary>The native library: loading, version check, and calls.</summary>
    internal static unsafe class Library
    {
        const string Folder = "Packages/com.anthronet.unity/Runtime/Plugins/";

#if UNITY_EDITOR_WIN || (UNITY_STANDALONE_WIN && !UNITY_EDITOR)
        const string Expected = "Windows/x86_64/anthronet.dll";
#elif UNITY_EDITOR_OSX || (UNITY_STANDALONE_OSX && !UNITY_EDITOR)
        const string Expected = "macOS/libanthronet.dylib";
#elif UNITY_ANDROID && !UNITY_EDITOR
        const string Expected = "Android/arm64-v8a/libanthronet.so";
#elif UNITY_IOS && !UNITY_EDITOR
        const string Expected = "iOS/libanthronet.a";
#elif UNITY_WEBGL && !UNITY_EDITOR
        // The library needs threads, which WebGL lacks: this is where an unsupported build would be.
        const string Expected = "WebGL/libanthronet.a";
#else
        const string Expected = "Linux/x86_64/libanthronet.so";
#endif

        static volatile bool ready;

        /// <summary>Path of the library for the current platform.</summary>
        internal static string ExpectedFile
        {
            get { return Folder + Expected; }
        }

        /// <summary>Checks that the library loads and has the version that this package was made for.</summary>
        /// <exception cref="DllNotFoundException">The library did not load; the message has its expected
        /// path.</exception>
        /// <exception cref="NotSupportedException">The library is of another release.</exception>
        internal static void Ensure()
        {
            if (ready)
            {
                return;
            }
            uint version;
            try
            {
                version = NativeMethods.anthronet_abi_version();
            }
            catch (Exception error) when (error is DllNotFoundException || error is EntryPointNotFoundException
                || error is BadImageFormatException)
            {
                throw Missing(error);
            }
            CheckVersion(version);
            ready = true;
        }

        /// <summary>The exception for a library that did not load.</summary>
        internal static DllNotFoundException Missing(Exception reason)
        {
            return new DllNotFoundException(
                "AnthroNet: the native library did not load: expected " + ExpectedFile + ", built for this platform and"
                + " enabled for it in its import settings. `cargo xtask package unity` adds the library for Linux;"
                + " Documentation~/platforms.md says how to build the others.", reason);
        }

        /// <summary>Throws if the library is of another release.</summary>
        internal static void CheckVersion(uint version)
        {
            if (version != NativeMethods.ANTHRONET_ABI_VERSION)
            {
                throw new NotSupportedException(
                    "AnthroNet: " + ExpectedFile + " has version " + version + " of the C interface, expected version "
                    + NativeMethods.ANTHRONET_ABI_VERSION + ": package and library have to be of the same release.");
            }
        }

        /// <summary>Returns the argument after checking it.</summary>
        /// <exception cref="ArgumentNullException">It is null.</exception>
        internal static T NotNull<T>(T value, string name) where T : class
        {
            if (value == null)
            {
                throw new ArgumentNullException(name);
            }
            return value;
        }

        /// <summary>A native function that writes a number.</summary>
        internal delegate int NumberCall(void* handle, uint* number, anthronet_error* error);

        /// <summary>A native function that writes a text, valid as long as the handle.</summary>
        internal delegate int TextCall(void* handle, anthronet_text* text, anthronet_error* error);

        /// <summary>A native function that creates bytes, such as JSON.</summary>
        internal delegate int BytesCall(void* handle, anthronet_bytes** bytes, anthronet_error* error);

        internal static int Number(AnthroHandle handle, NumberCall call)
        {
            using (var held = new Held(handle))
            {
                uint number;
                anthronet_error error;
                Check(call(held.Pointer, &number, &error), &error);
                return (int)number;
            }
        }

        internal static string Text(AnthroHandle handle, TextCall call)
        {
            using (var held = new Held(handle))
            {
                anthronet_text text;
                anthronet_error error;
                Check(call(held.Pointer, &text, &error), &error);
                return Utf8.Text(text);
            }
        }

        /// <summary>The text of bytes that a native function creates, which are freed.</summary>
        internal static string BytesText(AnthroHandle handle, BytesCall call)
        {
            using (var held = new Held(handle))
            {
                anthronet_bytes* bytes;
                anthronet_error error;
                Check(call(held.Pointer, &bytes, &error), &error);
                return Utf8.TakeText(bytes);
            }
        }

        /// <summary>Throws the error of a native call.</summary>
        /// <exception cref="AnthroException">The status is not ANTHRONET_OK.</exception>
        internal static void Check(int status, anthronet_error* error)
        {
            if (status != NativeMethods.ANTHRONET_OK)
            {
                throw new AnthroException((AnthroError)status, Utf8.ZeroTerminated(error->message, 512));
            }
        }
    }
}
