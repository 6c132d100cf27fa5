using System;
using System.Collections.Generic;

namespace Anthronet
{
    /// <summary>
    /// A body with its surfaces packed for upload, per level of detail: the expensive part of making a character, which
    /// may run on any thread. One thread at a time.
    /// </summary>
    internal sealed class AnthroBuild : IDisposable
    {
        readonly Dictionary<int, AnthroPacked> levels = new Dictionary<int, AnthroPacked>();
        readonly int skinTone;

        /// <summary>For a body, which the caller keeps owning.</summary>
        public AnthroBuild(AnthroBody body, int skinTone, bool bodyOnly)
        {
            Body = body;
            BodyOnly = bodyOnly;
            this.skinTone = skinTone;
        }

        public AnthroBody Body { get; private set; }

        public bool BodyOnly { get; private set; }

        /// <summary>The packed data of a level of detail that `Pack` was called for.</summary>
        public AnthroPacked this[int lod]
        {
            get { return levels[lod]; }
        }

        /// <summary>Packs a level of detail: everything, or only what updating an existing mesh needs.</summary>
        /// <returns>Whether there was anything to do.</returns>
        public bool Pack(int lod, bool complete)
        {
            AnthroPacked there;
            if (levels.TryGetValue(lod, out there) && (there.Complete || !complete))
            {
                return false;
            }
            using (var mesh = new AnthroMesh(Body, lod, skinTone, BodyOnly))
            {
                levels[lod] = new AnthroPacked(mesh, complete);
            }
            if (there != null)
            {
                there.Dispose();
            }
            return true;
        }

        /// <summary>Frees the packed data; the body stays.</summary>
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
