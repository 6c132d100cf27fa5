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

        /// <summary>The material of a part.</summary>
        public static Material Of(AnthroPart part)
        {
            var pipeline = Pipeline;
            var key = pipeline + " " + part.name + " " + part.baseColor + " " + part.roughness;
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
            var name = ShaderName(pipeline);
            var shader = Shader.Find(name);
            if (shader == null)
            {
                Debug.LogError("AnthroNet: the shader " + name + " is not in this build; put it into Always Included Shaders"
                    + " in the graphics settings, or give the character materials of your own");
                return null;
            }
            var material = new Material(shader);
            material.name = "AnthroNet " + part.name;
            material.enableInstancing = true;
            // Unity's properties of colours are gamma, the library's are linear.
            var color = part.baseColor.gamma;
            color.a = part.baseColor.a;
            var builtIn = pipeline == AnthroPipeline.BuiltIn;
            material.SetColor(builtIn ? "_Color" : "_BaseColor", color);
            material.SetFloat(builtIn ? "_Glossiness" : "_Smoothness", 1f - part.roughness);
            if (part.doubleSided && pipeline == AnthroPipeline.Universal)
            {
                material.SetFloat("_Cull", (float)CullMode.Off);
            }
            if (part.doubleSided && pipeline == AnthroPipeline.HighDefinition)
            {
                material.SetFloat("_DoubleSidedEnable", 1f);
                material.SetFloat("_CullMode", (float)CullMode.Off);
                material.SetFloat("_CullModeForward", (float)CullMode.Off);
                material.EnableKeyword("_DOUBLESIDED_ON");
            }
            return material;
        }

        [RuntimeInitializeOnLoadMethod(RuntimeInitializeLoadType.SubsystemRegistration)]
        static void Restart()
        {
            made.Clear();
        }
    }
}
