using System.Collections.Generic;
using UnityEngine;
using UnityEngine.Rendering;

namespace Anthronet
{
    /// <summary>Render pipelines with default materials.</summary>
    public enum AnthroPipeline
    {
        /// <summary>Built-in Render Pipeline.</summary>
        BuiltIn,
        /// <summary>Universal Render Pipeline (URP).</summary>
        Universal,
        /// <summary>High Definition Render Pipeline (HDRP).</summary>
        HighDefinition,
    }

    /// <summary>
    /// Default materials for the active render pipeline, shared by all characters. Main thread only.
    /// </summary>
    public static class AnthroMaterials
    {
        static readonly Dictionary<string, Material> made = new Dictionary<string, Material>();
        static readonly HashSet<string> missed = new HashSet<string>();

        /// <summary>Fallback shaders in order of preference, for builds without the pipeline's own.</summary>
        static readonly string[] fallbacks = { "Standard", "Diffuse", "Unlit/Color", "Sprites/Default" };

        /// <summary>The active render pipeline.</summary>
        public static AnthroPipeline Pipeline
        {
            get
            {
                var asset = GraphicsSettings.currentRenderPipeline;
                if (asset == null)
                {
                    return AnthroPipeline.BuiltIn;
                }
                // By type name, since neither pipeline package has to be installed.
                var kind = asset.GetType().Name;
                return kind.StartsWith("HD") || kind.Contains("HighDefinition")
                    ? AnthroPipeline.HighDefinition : AnthroPipeline.Universal;
            }
        }

        /// <summary>The shader for a render pipeline.</summary>
        public static string ShaderName(AnthroPipeline pipeline)
        {
            return pipeline == AnthroPipeline.BuiltIn ? "Standard"
                : pipeline == AnthroPipeline.Universal ? "Universal Render Pipeline/Lit" : "HDRP/Lit";
        }

        /// <summary>The default material of a mesh part; null, with an error in the console, if this build has no usable
        /// shader.</summary>
        public static Material Get(AnthroMeshPart part)
        {
            var pipeline = Pipeline;
            var key = pipeline + " " + part.name + " " + part.baseColor + " " + part.roughness + " " + part.doubleSided;
            Material material;
            // A cached material compares equal to null after its scene was unloaded.
            if (made.TryGetValue(key, out material) && material != null)
            {
                return material;
            }
            material = Make(part, pipeline);
            made[key] = material;
            return material;
        }

        static Material Make(AnthroMeshPart part, AnthroPipeline pipeline)
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
            // Unity's colour properties are in gamma space, the library's colours are linear.
            var color = part.baseColor.gamma;
            color.a = part.baseColor.a;
            // Only properties that the shader has: fallback shaders lack some.
            Set(material, "_BaseColor", color);
            Set(material, "_Color", color);
            Set(material, "_Smoothness", 1f - part.roughness);
            Set(material, "_Glossiness", 1f - part.roughness);
            if (part.doubleSided)
            {
                // The Built-in pipeline's Standard shader has no such property: it does not draw back faces of eyelashes.
                Set(material, "_Cull", (float)CullMode.Off);
                Set(material, "_CullMode", (float)CullMode.Off);
                Set(material, "_CullModeForward", (float)CullMode.Off);
                Set(material, "_TransparentCullMode", (float)CullMode.Off);
                Set(material, "_DoubleSidedEnable", 1f);
                material.doubleSidedGI = true;
                if (pipeline == AnthroPipeline.HighDefinition)
                {
                    // As HDRP's own inspector does: mirrors the normals of back faces.
                    Set(material, "_DoubleSidedNormalMode", 1f);
                    material.SetVector("_DoubleSidedConstants", new Vector4(1f, 1f, -1f, 0f));
                    material.EnableKeyword("_DOUBLESIDED_ON");
                }
            }
            return material;
        }

        /// <summary>Finds a shader or the first available fallback; reports a missing shader once.</summary>
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
                Debug.LogError("AnthroNet: the shader " + name + " is not in this build; add it to Always Included Shaders"
                    + " in the Graphics settings, or assign materials of your own to the character."
                    + (shader == null ? "" : " Using " + shader.name + " instead."));
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

        /// <summary>Destroys all cached materials; renderers that use them have none until their character is generated
        /// again.</summary>
        internal static void Release()
        {
            foreach (var material in made.Values)
            {
                AnthroObjects.DestroySafely(material);
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
