using System;
using System.Collections.Generic;

namespace Anthronet
{
    /// <summary>
    /// A body with its surfaces packed, level of detail by level: what takes long of making a character, done on any
    /// thread. One thread at a time.
    /// </summary>
    internal sealed class AnthroBuild : IDisposable
    {
        readonly Dictionary<int, AnthroPacked> levels = new Dictionary<int, AnthroPacked>();
        readonly int skinTone;

        /// <summary>For a body, which stays the caller's.</summary>
        public AnthroBuild(AnthroBody body, int skinTone, bool bodyOnly)
        {
            Body = body;
            BodyOnly = bodyOnly;
            this.skinTone = skinTone;
        }

        public AnthroBody Body { get; private set; }

        public bool BodyOnly { get; private set; }

        /// <summary>A level that `Pack` packed.</summary>
        public AnthroPacked this[int lod]
        {
            get { return levels[lod]; }
        }

        /// <summary>Packs a level, all of it or what an update needs.</summary>
        /// <returns>Whether there was anything to do.</returns>
        public bool Pack(int lod, bool whole)
        {
            AnthroPacked there;
            if (levels.TryGetValue(lod, out there) && (there.Whole || !whole))
            {
                return false;
            }
            using (var surface = new AnthroSurface(Body, lod, skinTone, BodyOnly))
            {
                levels[lod] = new AnthroPacked(surface, whole);
            }
            if (there != null)
            {
                there.Dispose();
            }
            return true;
        }

        /// <summary>Frees what was packed; the body stays.</summary>
        public void Dispose()
        {
            foreach (var level in levels.Values)
            {
                level.Dispose();
            }
            levels.Clear();
        }
    }
}
