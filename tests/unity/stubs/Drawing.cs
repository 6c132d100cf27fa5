// Stand-ins for Unity's rendering: renderers, levels of detail, materials, pipelines. See ../signatures.txt.
using System;
using System.Collections.Generic;

namespace UnityEngine
{
    public class Renderer : Component
    {
        bool on = true;
        Material[] worn = new Material[0];
        public bool enabled { get { return on; } set { on = value; } }
        /// A copy, as in Unity.
        public Material[] sharedMaterials
        {
            get { return (Material[])worn.Clone(); }
            set { worn = (Material[])value.Clone(); }
        }
        public Bounds localBounds { get; set; }
    }

    public class SkinnedMeshRenderer : Renderer
    {
        public Mesh sharedMesh { get; set; }
        public Transform[] bones { get; set; }
        public Transform rootBone { get; set; }
        readonly Dictionary<int, float> weights = new Dictionary<int, float>();
        public void SetBlendShapeWeight(int index, float value) { weights[index] = value; }
        public float GetBlendShapeWeight(int index) { float value; weights.TryGetValue(index, out value); return value; }
    }

    public struct LOD
    {
        public float screenRelativeTransitionHeight;
        public Renderer[] renderers;

        public LOD(float screenRelativeTransitionHeight, Renderer[] renderers)
        {
            this.screenRelativeTransitionHeight = screenRelativeTransitionHeight;
            this.renderers = renderers;
        }
    }

    public class LODGroup : Component
    {
        LOD[] lods;

        public void SetLODs(LOD[] lods)
        {
            for (var i = 1; i < lods.Length; i++)
            {
                if (lods[i].screenRelativeTransitionHeight >= lods[i - 1].screenRelativeTransitionHeight)
                {
                    throw new ArgumentException("SetLODs: heights have to fall");
                }
            }
            this.lods = lods;
        }

        public LOD[] GetLODs() { return lods; }
        public float size { get; set; }
        public Vector3 localReferencePoint { get; set; }
    }

    public sealed class Shader : Object
    {
        static readonly string[] none = new string[0];

        /// Shaders of the build, with their properties.
        internal static readonly Dictionary<string, string[]> Known = new Dictionary<string, string[]>
        {
            { "Standard", new[] { "_Color", "_Glossiness", "_Metallic" } },
            { "Universal Render Pipeline/Lit", new[] { "_BaseColor", "_Color", "_Smoothness", "_Cull" } },
            {
                "HDRP/Lit", new[]
                {
                    "_BaseColor", "_Smoothness", "_CullMode", "_CullModeForward", "_TransparentCullMode",
                    "_DoubleSidedEnable", "_DoubleSidedNormalMode", "_DoubleSidedConstants",
                }
            },
        };

        internal string[] Has = none;

        Shader() { Alive--; }

        public static Shader Find(string name)
        {
            return Known.ContainsKey(name) ? new Shader { name = name, Has = Known[name] } : null;
        }
    }

    public class Material : Object
    {
        internal readonly Dictionary<string, object> Values = new Dictionary<string, object>();

        public Material(Shader shader)
        {
            if (shader == null)
            {
                throw new ArgumentNullException("shader");
            }
            this.shader = shader;
        }

        public Material(Material source) : this(source.shader)
        {
            foreach (var value in source.Values)
            {
                Values[value.Key] = value.Value;
            }
        }

        public Shader shader { get; set; }
        public bool enableInstancing { get; set; }
        public bool doubleSidedGI { get; set; }
        public bool HasProperty(string name) { return Array.IndexOf(shader.Has, name) >= 0; }
        public void SetColor(string name, Color value) { Values[name] = value; }
        public void SetFloat(string name, float value) { Values[name] = value; }
        public void SetVector(string name, Vector4 value) { Values[name] = value; }
        public void EnableKeyword(string keyword) { Values[keyword] = true; }
    }
}

namespace UnityEngine.Rendering
{
    public enum CullMode
    {
        Off = 0,
        Front = 1,
        Back = 2,
    }

    public abstract class RenderPipelineAsset : ScriptableObject { }

    public static class GraphicsSettings
    {
        internal static RenderPipelineAsset Current;
        public static RenderPipelineAsset currentRenderPipeline { get { return Current; } }
    }
}
