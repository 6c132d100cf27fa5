using System;
using System.Collections.Generic;
using System.Linq;
using NUnit.Framework;
using UnityEngine;
using UnityEngine.Rendering;

namespace Anthronet.Tests
{
    /// Default materials.
    [TestFixture]
    public static class MaterialTests
    {
        sealed class UniversalRenderPipelineAsset : RenderPipelineAsset { }

        sealed class HDRenderPipelineAsset : RenderPipelineAsset { }

        [Test(Description = "materials match the active render pipeline and are shared")]
        public static void Materials()
        {
            var part = new AnthroMeshPart { name = "Lashes", roughness = 0.8f, doubleSided = true, baseColor = new Color(0.5f, 0, 0, 1) };
            string[] known = null, standard = null;
            try
            {
                var builtIn = AnthroMaterials.Get(part);
                Expect.Equal("Standard", builtIn.shader.name, "Built-in");
                Expect.Near(0.735, ((Color)builtIn.Values["_Color"]).r, 0.001, "colour");
                Expect.Near(0.2, (float)builtIn.Values["_Glossiness"], 1e-6, "smoothness");
                GraphicsSettings.Current = new UniversalRenderPipelineAsset();
                var universal = AnthroMaterials.Get(part);
                Expect.Equal("Universal Render Pipeline/Lit", universal.shader.name, "URP");
                Expect.That(universal.Values.ContainsKey("_BaseColor") && universal.Values.ContainsKey("_Cull"), "URP's");
                Expect.That(ReferenceEquals(universal, AnthroMaterials.Get(part)), "shared");
                GraphicsSettings.Current = new HDRenderPipelineAsset();
                var definition = AnthroMaterials.Get(part);
                Expect.Equal("HDRP/Lit", definition.shader.name, "HDRP");
                Expect.That(definition.Values.ContainsKey("_DOUBLESIDED_ON") && definition.doubleSidedGI, "both sides in HDRP");
                Expect.Near(1, (float)definition.Values["_DoubleSidedEnable"], 0, "both sides in HDRP");
                Expect.Near(0, (float)definition.Values["_CullModeForward"], 0, "culling in HDRP");
                part.doubleSided = false;
                var oneSided = AnthroMaterials.Get(part);
                Expect.That(!ReferenceEquals(definition, oneSided) && !oneSided.Values.ContainsKey("_DOUBLESIDED_ON"), "one side");
                // Without the pipeline's shader a fallback is used and reported; without any shader there is no material.
                known = Shader.Known["HDRP/Lit"];
                Shader.Known.Remove("HDRP/Lit");
                part.name = "Other";
                Debug.Errors.Clear();
                Expect.Equal("Standard", AnthroMaterials.Get(part).shader.name, "a missing shader");
                Expect.That(Debug.Errors.Single().Contains("HDRP/Lit"), "not reported");
                standard = Shader.Known["Standard"];
                Shader.Known.Remove("Standard");
                part.name = "Third";
                Expect.That(AnthroMaterials.Get(part) == null, "no shader, yet a material");
                // Characters work without materials.
                var character = Scene.Character(3, 3);
                Expect.That(character.GetRenderer(3).sharedMaterials.All(material => material == null), "materials");
                Scene.Destroy(character);
            }
            finally
            {
                GraphicsSettings.Current = null;
                Shader.Known["HDRP/Lit"] = known ?? Shader.Known["HDRP/Lit"];
                Shader.Known["Standard"] = standard ?? Shader.Known["Standard"];
                Debug.Errors.Clear();
            }
        }
    }
}
