using System;
using Anthronet.Native;
using UnityEngine;

namespace Anthronet
{
    /// <summary>A part of a mesh: one surface with one material.</summary>
    public struct AnthroMeshPart
    {
        /// <summary>Name, such as `Body`.</summary>
        public string name;
        /// <summary>Number of vertices.</summary>
        public int vertexCount;
        /// <summary>Number of triangles.</summary>
        public int triangleCount;
        /// <summary>Whether the material is double-sided.</summary>
        public bool doubleSided;
        /// <summary>Perceptual roughness of the material, 0 to 1.</summary>
        public float roughness;
        /// <summary>Base colour of the material, linear, with alpha.</summary>
        public Color baseColor;
    }

    /// <summary>Vertex attributes and indices of a mesh.</summary>
    internal enum AnthroAttribute : uint
    {
        Positions = NativeMethods.ANTHRONET_ATTRIBUTE_POSITIONS,
        Normals = NativeMethods.ANTHRONET_ATTRIBUTE_NORMALS,
        Uvs = NativeMethods.ANTHRONET_ATTRIBUTE_UVS,
        Triangles = NativeMethods.ANTHRONET_ATTRIBUTE_TRIANGLES,
        Joints = NativeMethods.ANTHRONET_ATTRIBUTE_JOINTS,
        Weights = NativeMethods.ANTHRONET_ATTRIBUTE_WEIGHTS,
    }

    /// <summary>
    /// The mesh of a body at one level of detail, in Unity's space and in native memory: the body part first, then
    /// eyes, teeth, tongue and eyelashes. `AnthroMeshes` makes Unity meshes of it. One thread at a time may change it.
    /// </summary>
    public sealed unsafe class AnthroMesh : IDisposable
    {
        readonly MeshHandle handle;
        readonly AnthroMeshPart[] parts;

        /// <summary>Makes the mesh of a body.</summary>
        /// <param name="body">The body; may be disposed afterwards.</param>
        /// <param name="lod">Level of detail, 0 (finest) to 3.</param>
        /// <param name="skinTone">Skin tone on the Monk scale, 1 to 10; 0 for the default.</param>
        /// <param name="bodyOnly">Leaves out eyes, teeth, tongue and eyelashes.</param>
        public AnthroMesh(AnthroBody body, int lod, int skinTone = 0, bool bodyOnly = false)
        {
            var options = new anthronet_mesh_options();
            options.struct_size = (uint)sizeof(anthronet_mesh_options);
            options.lod = checked((uint)lod);
            options.influences = Influences;
            options.space = NativeMethods.ANTHRONET_SPACE_UNITY;
            options.layout = NativeMethods.ANTHRONET_LAYOUT_RENDER;
            options.body_only = bodyOnly ? 1u : 0u;
            options.skin_tone = checked((uint)skinTone);
            anthronet_error error;
            using (var held = new Held(Library.NotNull(body, "body").Handle))
            {
                anthronet_mesh* made;
                Library.Check(NativeMethods.anthronet_mesh_new(
                    (anthronet_body*)held.Pointer, &options, &made, &error), &error);
                handle = new MeshHandle(made);
            }
            uint count;
            var mesh = (anthronet_mesh*)handle.DangerousGetHandle();
            Library.Check(NativeMethods.anthronet_mesh_part_count(mesh, &count, &error), &error);
            parts = new AnthroMeshPart[count];
            for (var i = 0u; i < count; i++)
            {
                var part = new anthronet_mesh_part();
                part.struct_size = (uint)sizeof(anthronet_mesh_part);
                Library.Check(NativeMethods.anthronet_mesh_describe_part(mesh, i, &part, &error), &error);
                parts[i].name = Utf8.Text(part.name);
                parts[i].vertexCount = (int)part.vertex_count;
                parts[i].triangleCount = (int)part.triangle_count;
                parts[i].doubleSided = part.double_sided != 0;
                parts[i].roughness = part.roughness;
                parts[i].baseColor = new Color(
                    part.base_color[0], part.base_color[1], part.base_color[2], part.base_color[3]);
                VertexCount += parts[i].vertexCount;
                TriangleCount += parts[i].triangleCount;
            }
        }

        /// <summary>Largest number of bone weights per vertex.</summary>
        internal const int Influences = 4;

        internal MeshHandle Handle
        {
            get { return handle; }
        }

        /// <summary>Number of parts.</summary>
        public int PartCount
        {
            get { return parts.Length; }
        }

        /// <summary>Description of a part.</summary>
        public AnthroMeshPart Part(int part)
        {
            return parts[part];
        }

        /// <summary>Number of vertices of all parts.</summary>
        public int VertexCount { get; private set; }

        /// <summary>Number of triangles of all parts.</summary>
        public int TriangleCount { get; private set; }

        /// <summary>Changes it to another body's shape; removes blend shapes.</summary>
        public void Update(AnthroBody body)
        {
            using (var other = new Held(Library.NotNull(body, "body").Handle))
            using (var held = new Held(handle))
            {
                anthronet_error error;
                Library.Check(NativeMethods.anthronet_mesh_update(
                    (anthronet_mesh*)held.Pointer, (anthronet_body*)other.Pointer, &error), &error);
            }
        }

        /// <summary>Adds a blend shape that leads to the surface of another body, which should have about the same
        /// stature.</summary>
        /// <exception cref="AnthroException">The name is empty or already used.</exception>
        public void AddBlendShape(string name, AnthroBody body)
        {
            ulong length;
            using (var other = new Held(Library.NotNull(body, "body").Handle))
            using (var held = new Held(handle))
            fixed (byte* data = Utf8.Bytes(name, "name", out length))
            {
                anthronet_error error;
                Library.Check(NativeMethods.anthronet_mesh_add_blend_shape((anthronet_mesh*)held.Pointer, data, length,
                    (anthronet_body*)other.Pointer, &error), &error);
            }
        }

        /// <summary>Number of blend shapes.</summary>
        public int BlendShapeCount
        {
            get
            {
                return Library.Number(handle, (pointer, count, error) =>
                    NativeMethods.anthronet_mesh_blend_shape_count((anthronet_mesh*)pointer, count, error));
            }
        }

        /// <summary>The name of a blend shape.</summary>
        public string BlendShapeName(int shape)
        {
            var index = checked((uint)shape);
            return Library.Text(handle, (pointer, name, error) =>
                NativeMethods.anthronet_mesh_blend_shape_name((anthronet_mesh*)pointer, index, name, error));
        }

        /// <summary>Copies an attribute of a part to memory, `stride` bytes per row.</summary>
        internal void Read(int part, AnthroAttribute attribute, void* rows, long bytes, int stride)
        {
            using (var held = new Held(handle))
            {
                anthronet_error error;
                Library.Check(NativeMethods.anthronet_mesh_read((anthronet_mesh*)held.Pointer, (uint)part,
                    (uint)attribute, rows, (ulong)bytes, (ulong)stride, &error), &error);
            }
        }

        /// <summary>Copies an attribute of a part's blend shape to memory, `stride` bytes per row.</summary>
        internal void ReadBlendShape(int shape, int part, AnthroAttribute attribute, void* rows, long bytes, int stride)
        {
            using (var held = new Held(handle))
            {
                anthronet_error error;
                Library.Check(NativeMethods.anthronet_mesh_read_blend_shape((anthronet_mesh*)held.Pointer, (uint)shape,
                    (uint)part, (uint)attribute, rows, (ulong)bytes, (ulong)stride, &error), &error);
            }
        }

        /// <summary>Pointer to an attribute of a part; valid until the mesh is changed or disposed.</summary>
        internal void* View(int part, AnthroAttribute attribute)
        {
            using (var held = new Held(handle))
            {
                anthronet_view view;
                anthronet_error error;
                Library.Check(NativeMethods.anthronet_mesh_data(
                    (anthronet_mesh*)held.Pointer, (uint)part, (uint)attribute, &view, &error), &error);
                return view.data;
            }
        }

        /// <summary>Frees the native memory. Meshes made from it stay valid.</summary>
        public void Dispose()
        {
            handle.Dispose();
        }
    }
}
