using System;
using System.Collections.Generic;
using System.Runtime.InteropServices;

namespace Anthronet.Native
{
    /// <summary>
    /// Live objects that hold native memory or threads. All of them are released before a domain reload: threads would
    /// run on in unloaded code, and native memory would leak.
    /// </summary>
    internal static class AnthroAlive
    {
        static readonly object gate = new object();
        static readonly List<WeakReference> all = new List<WeakReference>();
        static int sweepAt = 64;

        /// <summary>Registers an object without keeping it alive.</summary>
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

        /// <summary>Disposes everything: first the users of handles, then the handles.</summary>
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
