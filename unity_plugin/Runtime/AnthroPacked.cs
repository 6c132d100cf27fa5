using System;
using Anthronet.Native;
using UnityEngine;

namespace Anthronet
{
    /// <summary>
    /// A mesh in the memory layout of Unity's meshes, in native memory: any thread may pack it, and the main thread
    /// only copies. Vertex stream 0 has what differs between bodies.
    /// </summary>
    internal sealed unsafe class AnthroPacked : IDisposable
    {
        /// <summary>Floats per vertex in stream 0: position and normal.</summary>
        public const int FloatsPerVertex = 6;
        /// <summary>Bytes per vertex in stream 0.</summary>
        public const int Stride = FloatsPerVertex * sizeof(float);
        /// <summary>Bytes per vertex in stream 1: a texture coordinate.</summary>
        public const int UvStride = 2 * sizeof(float);
        /// <summary>Largest number of vertices of a part with 16-bit indices.</summary>
        public const int Max16BitVertices = 65535;

        readonly MemoryHandle memory;

        /// <summary>Packs a mesh.</summary>
        /// <param name="source">The mesh; may be disposed afterwards.</param>
        /// <param name="complete">False packs only stream 0 and bounds, which updating a mesh needs.</param>
        public AnthroPacked(AnthroMesh source, bool complete)
        {
            const int Each = AnthroMesh.Influences;
            Parts = new AnthroMeshPart[source.PartCount];
            Bounds = new Bounds[Parts.Length];
            VertexCount = source.VertexCount;
            IndexCount = 3 * source.TriangleCount;
            Complete = complete;
            for (var part = 0; part < Parts.Length; part++)
            {
                Parts[part] = source.Part(part);
                Use32BitIndices |= Parts[part].vertexCount > Max16BitVertices;
            }
            var bytes = (long)VertexCount * Stride;
            long uvs = bytes, indices = uvs + (long)VertexCount * UvStride;
            // Indices are padded to a multiple of four bytes; bone counts come last.
            var weights = indices + (IndexCount * (Use32BitIndices ? 4L : 2L) + 3) / 4 * 4;
            var numbers = weights + (long)VertexCount * Each * sizeof(BoneWeight1);
            memory = new MemoryHandle(complete ? numbers + VertexCount : bytes);
            try
            {
                Vertices = (float*)memory.Pointer;
                if (complete)
                {
                    Uvs = memory.Pointer + uvs;
                    Indices = memory.Pointer + indices;
                    Weights = (BoneWeight1*)(memory.Pointer + weights);
                    BonesPerVertex = memory.Pointer + numbers;
                }
                PackVertices(source);
                if (complete)
                {
                    PackUvsAndTriangles(source);
                    PackWeights(source);
                }
            }
            catch
            {
                Dispose();
                throw;
            }
        }

        public readonly AnthroMeshPart[] Parts;
        /// <summary>Bounds of each part.</summary>
        public readonly Bounds[] Bounds;
        /// <summary>Bounds of all parts.</summary>
        public Bounds TotalBounds;
        public readonly int VertexCount;
        public readonly int IndexCount;
        /// <summary>Whether everything is packed, or only stream 0.</summary>
        public readonly bool Complete;
        /// <summary>Whether indices have 32 bits instead of 16. They are relative to the part's first vertex.</summary>
        public readonly bool Use32BitIndices;
        public readonly float* Vertices;
        public readonly byte* Uvs;
        public readonly byte* Indices;
        /// <summary>Bone weights, vertex by vertex, largest first.</summary>
        public readonly BoneWeight1* Weights;
        /// <summary>Number of bone weights of each vertex.</summary>
        public readonly byte* BonesPerVertex;

        /// <summary>Total number of bone weights.</summary>
        public int WeightCount { get; private set; }

        void PackVertices(AnthroMesh source)
        {
            var first = Vertices;
            for (var part = 0; part < Parts.Length; part++)
            {
                var count = Parts[part].vertexCount;
                var bytes = (long)count * Stride;
                source.Read(part, AnthroAttribute.Positions, first, bytes, Stride);
                source.Read(part, AnthroAttribute.Normals, first + 3, bytes - Stride / 2, Stride);
                Bounds[part] = Box(first, count);
                if (part == 0)
                {
                    TotalBounds = Bounds[part];
                }
                TotalBounds.Encapsulate(Bounds[part]);
                first += FloatsPerVertex * count;
            }
        }

        void PackUvsAndTriangles(AnthroMesh source)
        {
            byte* uvs = Uvs, indices = Indices;
            for (var part = 0; part < Parts.Length; part++)
            {
                var bytes = (long)Parts[part].vertexCount * UvStride;
                source.Read(part, AnthroAttribute.Uvs, uvs, bytes, 0);
                uvs += bytes;
                var count = 3L * Parts[part].triangleCount;
                if (Use32BitIndices)
                {
                    source.Read(part, AnthroAttribute.Triangles, indices, count * sizeof(uint), 0);
                    indices += count * sizeof(uint);
                    continue;
                }
                var from = (uint*)source.View(part, AnthroAttribute.Triangles);
                var to = (ushort*)indices;
                for (var last = from + count; from < last;)
                {
                    *to++ = (ushort)*from++;
                }
                indices = (byte*)to;
            }
        }

        void PackWeights(AnthroMesh source)
        {
            const int Each = AnthroMesh.Influences;
            var row = Weights;
            var number = BonesPerVertex;
            var influence = new BoneWeight1();
            for (var part = 0; part < Parts.Length; part++)
            {
                var joints = (ushort*)source.View(part, AnthroAttribute.Joints);
                var weights = (float*)source.View(part, AnthroAttribute.Weights);
                for (var end = joints + Each * Parts[part].vertexCount; joints < end; joints += Each, weights += Each)
                {
                    // Sorted by weight: the first zero ends the list, and the first weight is never zero.
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
                for (var last = vertex + FloatsPerVertex * count; vertex < last; vertex += FloatsPerVertex)
                {
                    // Written out because Mono does not inline Vector3.Min.
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

        /// <summary>Frees the memory; meshes filled from it stay valid.</summary>
        public void Dispose()
        {
            memory.Dispose();
        }
    }
}
