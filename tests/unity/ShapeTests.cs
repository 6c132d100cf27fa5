using System;
using System.Collections.Generic;
using System.Linq;
using NUnit.Framework;
using UnityEngine;

namespace Anthronet.Tests
{
    /// Blend shapes.
    [TestFixture]
    public static class ShapeTests
    {
        [Test(Description = "blend shapes lead to the other body")]
        public static void Shapes()
        {
            using (var heavy = AnthroModel.Default.Generate(new AnthroRequest { Sex = AnthroSex.Male, Seed = 11 }
                .Set("height", 1.8).Set("waist_circumference", 1.2)))
            {
                var character = Scene.Character();
                character.AddBlendShape("heavy", heavy);
                using (var surface = new AnthroMesh(heavy, 1))
                {
                    var other = AnthroMeshes.Create(surface, heavy.Joints(), "heavy");
                    var mesh = character.GetMesh(1);
                    Vector3[] way = mesh.Shapes["heavy"], turn = mesh.ShapeNormals["heavy"];
                    Expect.That(turn.Any(delta => delta.magnitude > 0.1f), "normals do not turn");
                    for (var v = 0; v < mesh.vertexCount; v++)
                    {
                        Expect.That((mesh.Position(v) + way[v] - other.Position(v)).magnitude < 1e-5, "vertex " + v);
                        Expect.That((mesh.Normal(v) + turn[v] - other.Normal(v)).magnitude < 1e-5, "normal " + v);
                    }
                    UnityEngine.Object.Destroy(other);
                }
                Expect.Code(AnthroError.Invalid, "", () => character.AddBlendShape("", heavy), "no name");
                character.Generate();
                Expect.Equal(0, character.GetMesh(1).blendShapeCount, "shapes of the body before");
                UnityEngine.Object.Destroy(character.gameObject);
            }
        }

        [Test(Description = "blend shapes reuse pooled arrays for all levels of detail")]
        public static void Pooled()
        {
            using (var heavy = AnthroModel.Default.Generate(Scene.Request().Set("waist_circumference", 1.2)))
            {
                var character = Scene.Character(2, 3);
                character.AddBlendShape("first", heavy);
                var pool = (Dictionary<int, Vector3[][]>)Scene.Static(typeof(AnthroMeshes), "pool");
                var arrays = new[] { 2, 3 }.Select(lod => pool[character.GetMesh(lod).vertexCount][0]).ToArray();
                character.AddBlendShape("second", heavy);
                Expect.That(new[] { 2, 3 }.Select(lod => pool[character.GetMesh(lod).vertexCount][0]).SequenceEqual(arrays), "new ones");
                character.SetBlendShapeWeight("second", 40f);
                foreach (var lod in new[] { 2, 3 })
                {
                    Expect.Equal(40f, character.GetRenderer(lod).GetBlendShapeWeight(1), "weight of LOD" + lod);
                    Expect.Equal(0f, character.GetRenderer(lod).GetBlendShapeWeight(0), "weight of the other one");
                }
                Expect.Throws<ArgumentException>(() => character.SetBlendShapeWeight("third", 1f), "a name that there is not");
                Expect.Equal(2, character.GetMesh(2).blendShapeCount, "shapes");
                Scene.Destroy(character);
            }
        }
    }
}
