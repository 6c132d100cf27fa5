using System;
using System.Collections.Generic;
using System.Runtime.InteropServices;

namespace Anthronet.Native
{
    /// <summary>
    /// What holds native memory or threads. Before Unity unloads the code all of it is released: threads would run on in
    /// code that is gone, and native memory would be nobody's.
    /// </summary>
    internal static class AnthroAlive
    {
        static readonly object gate = new object();
        static readonly List<WeakReference> all = new List<WeakReference>();
        static int sweepAt = 64;

        /// <summary>Remembers an object without keeping it alive.</summary>
        internal static void Add(IDisposable one)
        {
            lock (gate)
            {
                if (all.Count >= sweepAt)
                {
                    all.RemoveAll(reference => !reference.IsAlive);
                    sweepAt = 2 * all.Count + 64;
                }
                all.Add(new WeakReference(one));
            }
        }

        /// <summary>Disposes of everything: first what uses handles, then the handles.</summary>
        internal static void ReleaseAll()
        {
            WeakReference[] those;
            lock (gate)
            {
                those = all.ToArray();
                all.Clear();
            }
            Release(those, false);
            Release(those, true);
        }

        static void Release(WeakReference[] those, bool handles)
        {
            foreach (var reference in those)
            {
                var one = reference.Target as IDisposable;
                if (one != null && one is SafeHandle == handles)
                {
                    one.Dispose();
                }
            }
        }
    }
}
