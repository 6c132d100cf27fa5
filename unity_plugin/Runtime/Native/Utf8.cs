using System;
using System.Text;

namespace Anthronet.Native
{
    /// <summary>Converts text from and to the library's UTF-8 with explicit lengths.</summary>
    internal static unsafe class Utf8
    {
        static readonly UTF8Encoding Strict = new UTF8Encoding(false, true);

        /// <summary>The UTF-8 bytes of a text, with one zero appended so that the array is never empty.</summary>
        /// <exception cref="ArgumentNullException">The text is null.</exception>
        /// <exception cref="ArgumentException">The text has an unpaired surrogate.</exception>
        internal static byte[] Bytes(string text, string what, out ulong length)
        {
            if (text == null)
            {
                throw new ArgumentNullException(what);
            }
            var bytes = new byte[Strict.GetByteCount(text) + 1];
            length = (ulong)Strict.GetBytes(text, 0, text.Length, bytes, 0);
            return bytes;
        }

        internal static string Text(anthronet_text text)
        {
            return Text(text.data, text.length);
        }

        internal static string Text(byte* data, ulong length)
        {
            return length == 0 ? string.Empty : Encoding.UTF8.GetString(data, checked((int)length));
        }

        /// <summary>Text that ends at a zero byte or at the capacity.</summary>
        internal static string ZeroTerminated(byte* data, int capacity)
        {
            var length = 0;
            while (length < capacity && data[length] != 0)
            {
                length++;
            }
            return Text(data, (ulong)length);
        }

        /// <summary>The library's bytes as text, freeing them.</summary>
        internal static string TakeText(anthronet_bytes* bytes)
        {
            using (var held = new BytesHandle(bytes))
            {
                byte* data;
                ulong length;
                Data(bytes, out data, out length);
                return Text(data, length);
            }
        }

        /// <summary>A copy of the library's bytes, freeing them.</summary>
        internal static byte[] TakeBytes(anthronet_bytes* bytes)
        {
            using (var held = new BytesHandle(bytes))
            {
                byte* data;
                ulong length;
                Data(bytes, out data, out length);
                var copy = new byte[checked((int)length)];
                if (copy.Length > 0)
                {
                    System.Runtime.InteropServices.Marshal.Copy((IntPtr)data, copy, 0, copy.Length);
                }
                return copy;
            }
        }

        static void Data(anthronet_bytes* bytes, out byte* data, out ulong length)
        {
            byte* first;
            ulong count;
            anthronet_error error;
            Library.Check(NativeMethods.anthronet_bytes_data(bytes, &first, &count, &error), &error);
            data = first;
            length = count;
        }
    }
}
