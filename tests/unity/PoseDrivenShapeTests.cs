using System;
using System.Linq;
using System.Reflection;
using NUnit.Framework;
using UnityEngine;
using UnityEngine.Scripting.APIUpdating;
using UnityEngine.Serialization;

namespace Anthronet.Tests
{
    /// Blend shapes whose weights follow joint angles.
    [TestFixture]
    public static class PoseDrivenShapeTests
    {
        static float Weight(AnthroCharacter character, int lod, int shape)
        {
            return character.GetRenderer(lod).GetBlendShapeWeight(shape);
        }

        static void Bend(AnthroCharacter character, string joint, float degrees)
        {
            var place = Scene.Joint(character, joint);
            var half = degrees * Math.PI / 360.0;
            var by = new Quaternion((float)Math.Sin(half), 0f, 0f, (float)Math.Cos(half));
            character.Rig.Bones[place].localRotation = character.Rig.Joints[place].parentFromJoint.rotation * by;
        }

        [Test(Description = "pose-driven shapes: weights follow the elbow of their side, on all levels of detail, every frame")]
        public static void Weights()
        {
            var character = Scene.Character(1, 2);
            var poseDriven = character.gameObject.AddComponent<AnthroPoseDrivenShapes>();
            foreach (var lod in new[] { 1, 2 })
            {
                Expect.Equal(2, character.GetMesh(lod).blendShapeCount, "shapes of LOD" + lod);
            }
            foreach (var step in new[] { new[] { 0f, 0f }, new[] { 15f, 0f }, new[] { 67.5f, 50f }, new[] { 120f, 100f }, new[] { 150f, 100f } })
            {
                Bend(character, "lowerarm_l", step[0]);
                MonoBehaviour.Send(poseDriven, "LateUpdate");
                foreach (var lod in new[] { 1, 2 })
                {
                    Expect.That(Math.Abs(Weight(character, lod, 0) - step[1]) < 0.01, step[0] + " degrees, LOD" + lod + ": " + Weight(character, lod, 0));
                    Expect.Equal(0f, Weight(character, lod, 1), "the other arm");
                }
            }
            character.Rig.ApplyBindPose();
            poseDriven.Apply();
            Expect.Equal(0f, Weight(character, 1, 0), "in the bind pose");
            Scene.Destroy(character);
        }

        [Test(Description = "pose-driven shapes: a shape moves the measured part of its side and hardly anything else")]
        public static void Shapes()
        {
            var character = Scene.Character();
            character.gameObject.AddComponent<AnthroPoseDrivenShapes>();
            var mesh = character.GetMesh(1);
            var offsets = mesh.Shapes[mesh.Shapes.Keys.First()];
            Func<string, Vector3> joint =
                name => character.Rig.Joints[Scene.Joint(character, name)].modelFromJoint.MultiplyPoint3x4(Vector3.zero);
            Vector3 shoulder = joint("upperarm_l"), elbow = joint("lowerarm_l"), knee = joint("calf_l");
            float arm = 0f, other = 0f, legs = 0f;
            for (var v = 0; v < mesh.vertexCount; v++)
            {
                var at = mesh.Position(v);
                // The character's left is at -X in Unity.
                var between = at.x < 0.7f * shoulder.x + 0.3f * elbow.x && at.x > 0.3f * shoulder.x + 0.7f * elbow.x;
                arm = between ? Math.Max(arm, offsets[v].magnitude) : arm;
                other = -at.x < 0.7f * shoulder.x + 0.3f * elbow.x ? Math.Max(other, offsets[v].magnitude) : other;
                legs = at.y < knee.y ? Math.Max(legs, offsets[v].magnitude) : legs;
            }
            // 5 % of a circumference of 0.3 m is 2.4 mm of radius.
            Expect.That(arm > 0.0015f && arm < 0.008f, "arm " + arm);
            Expect.That(other < 0.35f * arm && legs < 0.35f * arm, "arm " + arm + ", other arm " + other + ", legs " + legs);
            Scene.Destroy(character);
        }

        [Test(Description = "pose-driven shapes: rebuilt when the character changes, and errors name the culprit")]
        public static void Anew()
        {
            var character = Scene.Character(3, 3);
            var poseDriven = character.gameObject.AddComponent<AnthroPoseDrivenShapes>();
            character.Request = Scene.Request(1.6);
            character.Generate();
            Expect.Equal(2, character.GetMesh(3).blendShapeCount, "shapes of the next body");
            Bend(character, "lowerarm_r", 120f);
            poseDriven.Apply();
            Expect.That(Math.Abs(Weight(character, 3, 1) - 100f) < 0.01, "weight on the next body");

            poseDriven.Shapes[0].joint = "elbow";
            Expect.That(Expect.Throws<ArgumentException>(poseDriven.Rebuild, "joint").Message.Contains("\"elbow\""), "names the joint");
            poseDriven.Shapes[0].joint = "lowerarm_l";
            poseDriven.Shapes[0].measure = "biceps";
            Expect.Code(AnthroError.Request, "biceps", poseDriven.Rebuild, "measure");
            poseDriven.Shapes[0].measure = "arm_circumference";
            poseDriven.Shapes[0].endDegrees = 10f;
            Expect.That(Expect.Throws<ArgumentException>(poseDriven.Rebuild, "angles").Message.Contains("15 and 10"), "says the angles");
            Expect.Equal(2, character.GetMesh(3).blendShapeCount, "after errors");
            poseDriven.Shapes[0].endDegrees = 90f;
            poseDriven.Rebuild();
            Expect.Equal(2, character.GetMesh(3).blendShapeCount, "after a change");
            Scene.Destroy(character);
        }

        [Test(Description = "pose-driven shapes: renamed types and fields keep their former names for Unity")]
        public static void FormerNames()
        {
            Expect.Equal("AnthroCorrectives", FormerName(typeof(AnthroPoseDrivenShapes)), "component");
            Expect.Equal("AnthroCorrective", FormerName(typeof(AnthroPoseDrivenShape)), "shape");
            Expect.Equal("correctives", FormerName(typeof(AnthroPoseDrivenShapes), "shapes"), "list");
            Expect.Equal("from", FormerName(typeof(AnthroPoseDrivenShape), "startDegrees"), "start");
            Expect.Equal("to", FormerName(typeof(AnthroPoseDrivenShape), "endDegrees"), "end");
            Expect.Equal("change", FormerName(typeof(AnthroPoseDrivenShape), "relativeChange"), "change");
        }

        static string FormerName(Type type)
        {
            return ((MovedFromAttribute)Attribute.GetCustomAttribute(type, typeof(MovedFromAttribute))).SourceClassName;
        }

        static string FormerName(Type type, string field)
        {
            var found = type.GetField(field, BindingFlags.Instance | BindingFlags.Public | BindingFlags.NonPublic);
            return found.GetCustomAttribute<FormerlySerializedAsAttribute>().oldName;
        }
    }
}
