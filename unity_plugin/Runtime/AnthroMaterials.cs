using System.Collections.Generic;
using UnityEngine;
using UnityEngine.Rendering;

namespace Anthronet
{
    /// <summary>Render pipelines that materials are made for.</summary>
    public enum AnthroPipeline
    {
        /// <summary>Unity's own.</summary>
        BuiltIn,
        /// <summary>URP.</summary>
        Universal,
        /// <summary>HDRP.</summary>
        HighDefinition,
    }

    /// <summary>
    /// Materials of the parts for the pipeline that is in use, shared by all characters with the same ones. On the main
    /// thread alone.
    /// </summary>
    public static class AnthroMaterials
    {
        static readonly Dictionary<string, Material> made = new Dictionary<string, Material>();
        static readonly HashSet<string> missed = new HashSet<string>();

        /// <summary>Shaders that may stand in, the best first: what a build without a pipeline's own still has.</summary>
        static readonly string[] fallbacks = { "Standard", "Diffuse", "Unlit/Color", "Sprites/Default" };

        /// <summary>The pipeline in use.</summary>
        public static AnthroPipeline Pipeline
        {
            get
            {
                var asset = GraphicsSettings.currentRenderPipeline;
                if (asset == null)
                {
                    return AnthroPipeline.BuiltIn;
                }
                // By name: neither package has to be installed.
                var kind = asset.GetType().Name;
                return kind.StartsWith("HD") || kind.Contains("HighDefinition")
                    ? AnthroPipeline.HighDefinition : AnthroPipeline.Universal;
            }
        }

        /// <summary>The shader of a pipeline.</summary>
        public static string ShaderName(AnthroPipeline pipeline)
        {
            return pipeline == AnthroPipeline.BuiltIn ? "Standard"
                : pipeline == AnthroPipeline.Universal ? "Universal Render Pipeline/Lit" : "HDRP/Lit";
        }

        /// <summary>The material of a part; null, with an error in the console, where this build has no shader for it.
        /// </summary>
        public static Material Of(AnthroPart part)
        {
            var pipeline = Pipeline;
            var key = pipeline + " " + part.name + " " + part.baseColor + " " + part.roughness + " " + part.doubleSided;
            Material material;
            // A material of a scene that was closed is null to Unity.
            if (made.TryGetValue(key, out material) && material != null)
            {
                return material;
            }
            material = Make(part, pipeline);
            made[key] = material;
            return material;
        }

        static Material Make(AnthroPart part, AnthroPipeline pipeline)
        {
            var shader = Find(ShaderName(pipeline));
            if (shader == null)
            {
                return null;
            }
            var material = new Material(shader);
            material.name = "AnthroNet " + part.name;
            material.hideFlags = Application.isPlaying ? HideFlags.None : HideFlags.DontSave;
            material.enableInstancing = true;
            // Unity's properties of colours are gamma, the library's are linear.
            var color = part.baseColor.gamma;
            color.a = part.baseColor.a;
            // By what the shader has: a stand-in has not all of it.
            Set(material, "_BaseColor", color);
            Set(material, "_Color", color);
            Set(material, "_Smoothness", 1f - part.roughness);
            Set(material, "_Glossiness", 1f - part.roughness);
            if (part.doubleSided)
            {
                // Built-in's Standard cannot: there back faces of lashes are not drawn.
                Set(material, "_Cull", (float)CullMode.Off);
                Set(material, "_CullMode", (float)CullMode.Off);
                Set(material, "_CullModeForward", (float)CullMode.Off);
                Set(material, "_TransparentCullMode", (float)CullMode.Off);
                Set(material, "_DoubleSidedEnable", 1f);
                material.doubleSidedGI = true;
                if (pipeline == AnthroPipeline.HighDefinition)
                {
                    // As HDRP's own inspector sets it: normals of back faces are mirrored.
                    Set(material, "_DoubleSidedNormalMode", 1f);
                    material.SetVector("_DoubleSidedConstants", new Vector4(1f, 1f, -1f, 0f));
                    material.EnableKeyword("_DOUBLESIDED_ON");
                }
            }
            return material;
        }

        /// <summary>A shader, or the first there is that may stand in for it; told once.</summary>
        static Shader Find(string name)
        {
            var shader = Shader.Find(name);
            if (shader != null)
            {
                return shader;
            }
            for (var i = 0; i < fallbacks.Length && shader == null; i++)
            {
                shader = Shader.Find(fallbacks[i]);
            }
            if (missed.Add(name))
            {
                Debug.LogError("AnthroNet: the shader " + name + " is not in this build; put it into Always Included Shaders"
                    + " in the graphics settings, or give the character materials of your own."
                    + (shader == null ? "" : " " + shader.name + " stands in for it."));
            }
            return shader;
        }

        static void Set(Material material, string property, float value)
        {
            if (material.HasProperty(property))
            {
                material.SetFloat(property, value);
            }
        }

        static void Set(Material material, string property, Color value)
        {
            if (material.HasProperty(property))
            {
                material.SetColor(property, value);
            }
        }

        /// <summary>Destroys all that were made; those that wear them have none until they are generated anew.</summary>
        internal static void Release()
        {
            foreach (var material in made.Values)
            {
                AnthroObjects.Discard(material);
            }
            made.Clear();
            missed.Clear();
        }

        [RuntimeInitializeOnLoadMethod(RuntimeInitializeLoadType.SubsystemRegistration)]
        static void Restart()
        {
            made.Clear();
            missed.Clear();
        }
    }
}
