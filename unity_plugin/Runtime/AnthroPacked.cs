using System;
using Anthronet.Native;
using UnityEngine;

namespace Anthronet
{
    /// <summary>
    /// A surface laid out as Unity's meshes hold it, in memory of our own: any thread may make it, and the main thread has
    /// no more to do than to copy. Stream 0 is what differs from body to body.
    /// </summary>
    internal sealed unsafe class AnthroPacked : IDisposable
    {
        /// <summary>Floats of a vertex in stream 0: position and normal.</summary>
        public const int Floats = 6;
        /// <summary>Bytes of a vertex in stream 0.</summary>
        public const int Stride = Floats * sizeof(float);
        /// <summary>Bytes of a vertex in stream 1: a texture coordinate.</summary>
        public const int UvStride = 2 * sizeof(float);
        /// <summary>Most vertices of a part whose triangles are numbered with 16 bits.</summary>
        public const int Narrow = 65535;

        readonly MemoryHandle memory;

        /// <summary>Packs a surface.</summary>
        /// <param name="surface">It; not needed afterwards.</param>
        /// <param name="whole">False packs stream 0 and bounds alone: what an update takes.</param>
        public AnthroPacked(AnthroSurface surface, bool whole)
        {
            const int Each = AnthroSurface.Influences;
            Parts = new AnthroPart[surface.PartCount];
            Bounds = new Bounds[Parts.Length];
            VertexCount = surface.VertexCount;
            IndexCount = 3 * surface.TriangleCount;
            Whole = whole;
            for (var part = 0; part < Parts.Length; part++)
            {
                Parts[part] = surface.Part(part);
                Wide |= Parts[part].vertexCount > Narrow;
            }
            var bytes = (long)VertexCount * Stride;
            long uvs = bytes, indices = uvs + (long)VertexCount * UvStride;
            // Indices end at a multiple of four bytes, the weights' numbers stand last.
            var weights = indices + (IndexCount * (Wide ? 4L : 2L) + 3) / 4 * 4;
            var numbers = weights + (long)VertexCount * Each * sizeof(BoneWeight1);
            memory = new MemoryHandle(whole ? numbers + VertexCount : bytes);
            try
            {
                Vertices = (float*)memory.Pointer;
                if (whole)
                {
                    Uvs = memory.Pointer + uvs;
                    Indices = memory.Pointer + indices;
                    Weights = (BoneWeight1*)(memory.Pointer + weights);
                    Numbers = memory.Pointer + numbers;
                }
                PackVertices(surface);
                if (whole)
                {
                    PackTriangles(surface);
                    PackWeights(surface);
                }
            }
            catch
            {
                Dispose();
                throw;
            }
        }

        public readonly AnthroPart[] Parts;
        /// <summary>Around each part.</summary>
        public readonly Bounds[] Bounds;
        /// <summary>Around all of them.</summary>
        public Bounds Around;
        public readonly int VertexCount;
        public readonly int IndexCount;
        /// <summary>Whether all is packed, or no more than stream 0.</summary>
        public readonly bool Whole;
        /// <summary>Whether indices have 32 bits, not 16. They count from their part's first vertex.</summary>
        public readonly bool Wide;
        public readonly float* Vertices;
        public readonly byte* Uvs;
        public readonly byte* Indices;
        /// <summary>Influences, those of a vertex one after the other, falling.</summary>
        public readonly BoneWeight1* Weights;
        /// <summary>Number of influences of each vertex.</summary>
        public readonly byte* Numbers;

        /// <summary>Number of influences altogether.</summary>
        public int WeightCount { get; private set; }

        void PackVertices(AnthroSurface surface)
        {
            var first = Vertices;
            for (var part = 0; part < Parts.Length; part++)
            {
                var count = Parts[part].vertexCount;
                var bytes = (long)count * Stride;
                surface.Read(part, AnthroAttribute.Positions, first, bytes, Stride);
                surface.Read(part, AnthroAttribute.Normals, first + 3, bytes - Stride / 2, Stride);
                Bounds[part] = Box(first, count);
                if (part == 0)
                {
                    Around = Bounds[part];
                }
                Around.Encapsulate(Bounds[part]);
                first += Floats * count;
            }
        }

        void PackTriangles(AnthroSurface surface)
        {
            byte* uvs = Uvs, indices = Indices;
            for (var part = 0; part < Parts.Length; part++)
            {
                var bytes = (long)Parts[part].vertexCount * UvStride;
                surface.Read(part, AnthroAttribute.Uvs, uvs, bytes, 0);
                uvs += bytes;
                var count = 3L * Parts[part].triangleCount;
                if (Wide)
                {
                    surface.Read(part, AnthroAttribute.Triangles, indices, count * sizeof(uint), 0);
                    indices += count * sizeof(uint);
                    continue;
                }
                var from = (uint*)surface.View(part, AnthroAttribute.Triangles);
                var to = (ushort*)indices;
                for (var last = from + count; from < last;)
                {
                    *to++ = (ushort)*from++;
                }
                indices = (byte*)to;
            }
        }

        void PackWeights(AnthroSurface surface)
        {
            const int Each = AnthroSurface.Influences;
            var row = Weights;
            var number = Numbers;
            var influence = new BoneWeight1();
            for (var part = 0; part < Parts.Length; part++)
            {
                var joints = (ushort*)surface.View(part, AnthroAttribute.Joints);
                var weights = (float*)surface.View(part, AnthroAttribute.Weights);
                for (var end = joints + Each * Parts[part].vertexCount; joints < end; joints += Each, weights += Each)
                {
                    // They come sorted: behind the first zero there is nothing, and the first is none.
                    byte there = 0;
                    while (there < Each && weights[there] > 0f)
                    {
                        influence.boneIndex = joints[there];
                        influence.weight = weights[there];
                        *row++ = influence;
                        there++;
                    }
                    *number++ = there;
                }
            }
            WeightCount = (int)(row - Weights);
        }

        static Bounds Box(float* vertex, int count)
        {
            var bounds = new Bounds();
            if (count > 0)
            {
                Vector3 min = *(Vector3*)vertex, max = min;
                for (var last = vertex + Floats * count; vertex < last; vertex += Floats)
                {
                    // By hand: mono calls Vector3.Min for every vertex.
                    var position = (Vector3*)vertex;
                    if (position->x < min.x) min.x = position->x;
                    else if (position->x > max.x) max.x = position->x;
                    if (position->y < min.y) min.y = position->y;
                    else if (position->y > max.y) max.y = position->y;
                    if (position->z < min.z) min.z = position->z;
                    else if (position->z > max.z) max.z = position->z;
                }
                bounds.SetMinMax(min, max);
            }
            return bounds;
        }

        /// <summary>Frees the memory; meshes filled from it stay whole.</summary>
        public void Dispose()
        {
            memory.Dispose();
        }
    }
}
