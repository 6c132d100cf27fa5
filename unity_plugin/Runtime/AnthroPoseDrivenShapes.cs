using System;
using System.Collections.Generic;
using UnityEngine;
using UnityEngine.Scripting.APIUpdating;
using UnityEngine.Serialization;

namespace Anthronet
{
    /// <summary>A blend shape that changes one measure, and the joint whose rotation sets its weight.</summary>
    [Serializable]
    [MovedFrom(true, null, null, "AnthroCorrective")]
    public sealed class AnthroPoseDrivenShape
    {
        /// <summary>The driving joint, by its name in the rig.</summary>
        [Tooltip("The joint whose rotation sets the weight, by its name in the rig, such as lowerarm_l.")]
        public string joint = "lowerarm_l";

        /// <summary>Up to this angle from the bind pose the weight is 0; degrees, at least 0.</summary>
        [FormerlySerializedAs("from")]
        [Tooltip("Degrees from the bind pose up to which the weight is 0; at least 0.")]
        public float startDegrees = 15f;

        /// <summary>From this angle on the weight is 100; degrees, greater than `startDegrees`.</summary>
        [FormerlySerializedAs("to")]
        [Tooltip("Degrees from the bind pose from which on the weight is 100; greater than Start Degrees.")]
        public float endDegrees = 120f;

        /// <summary>The measure that the shape changes; a name without a side changes both sides.</summary>
        [Tooltip("The measure that the shape changes, such as arm_circumference_left; a name without a side changes both sides.")]
        public string measure = "arm_circumference_left";

        /// <summary>Change of the measure at full weight, relative to its value: 0.05 is 5 % more.</summary>
        [FormerlySerializedAs("change")]
        [Tooltip("Change of the measure at full weight, relative to its value: 0.05 is 5 % more, -0.05 is 5 % less.")]
        public float relativeChange = 0.05f;
    }

    /// <summary>
    /// Sets blend-shape weights from joint angles. Each blend shape leads to the same person with one measure changed;
    /// its weight follows the angle of one joint from the bind pose, where it is exactly 0. The shapes are made when the
    /// character is generated, about 10 ms each. By default upper arms swell by 5 % as elbows bend, a conservative value
    /// that was not measured. These are not learned pose correctives.
    /// </summary>
    [AddComponentMenu("AnthroNet/AnthroNet Pose-Driven Shapes")]
    [DisallowMultipleComponent]
    // After the animators, which set the pose in their own `LateUpdate`.
    [DefaultExecutionOrder(100)]
    [MovedFrom(true, null, null, "AnthroCorrectives")]
    public sealed class AnthroPoseDrivenShapes : AnthroCharacterBehaviour
    {
        [FormerlySerializedAs("correctives")]
        [Tooltip("The blend shapes and the joints that drive them.")]
        [SerializeField] List<AnthroPoseDrivenShape> shapes = new List<AnthroPoseDrivenShape>
        {
            new AnthroPoseDrivenShape(),
            new AnthroPoseDrivenShape { joint = "lowerarm_r", measure = "arm_circumference_right" },
        };

        struct Driver
        {
            public AnthroPoseDrivenShape shape;
            public string blendShape;
            public Transform bone;
            public Quaternion bindRotation;
        }

        readonly List<Driver> drivers = new List<Driver>();
        AnthroBody madeFor;

        /// <summary>The shapes; after changing them call `Rebuild`.</summary>
        public List<AnthroPoseDrivenShape> Shapes
        {
            get { return shapes; }
        }

        internal override void OnBody(AnthroBody body)
        {
            if (ReferenceEquals(body, madeFor) && HasBlendShapes())
            {
                return;
            }
            try
            {
                Rebuild();
            }
            catch (Exception error)
            {
                // Nobody could catch an exception here, and the character works without the shapes.
                Debug.LogException(error, this);
            }
        }

        bool HasBlendShapes()
        {
            return drivers.TrueForAll(driver => Character.HasBlendShape(driver.blendShape));
        }

        /// <summary>Makes the blend shapes for the character's current body. Removes all blend shapes that the character
        /// had.</summary>
        /// <exception cref="AnthroException">A measure does not exist.</exception>
        /// <exception cref="ArgumentException">A joint does not exist, or the angles are not in order.</exception>
        /// <exception cref="InvalidOperationException">The character is not generated yet.</exception>
        public void Rebuild()
        {
            var body = RequireBody();
            var next = new List<Driver>();
            foreach (var shape in shapes)
            {
                next.Add(CreateDriver(shape, Character.Rig, next.Count));
            }
            drivers.Clear();
            madeFor = null;
            Character.ClearBlendShapes();
            foreach (var driver in next)
            {
                using (var target = TargetBody(body, driver.shape))
                {
                    Character.AddBlendShape(driver.blendShape, target);
                }
            }
            drivers.AddRange(next);
            madeFor = body;
            Apply();
        }

        static Driver CreateDriver(AnthroPoseDrivenShape shape, AnthroRig rig, int index)
        {
            var joint = rig.IndexOf(shape.joint);
            if (joint < 0)
            {
                throw new ArgumentException(
                    "pose-driven shape " + index + ": the rig has no joint \"" + shape.joint + "\"", "joint");
            }
            if (!(shape.startDegrees >= 0f && shape.endDegrees > shape.startDegrees))
            {
                throw new ArgumentException("pose-driven shape " + index
                    + ": expected 0 <= startDegrees < endDegrees, got " + shape.startDegrees + " and " + shape.endDegrees,
                    "startDegrees");
            }
            // Reports an unknown measure before any blend shape is removed.
            int first, second;
            AnthroMeasures.IndicesOf(shape.measure, out first, out second);
            return new Driver
            {
                shape = shape,
                blendShape = "pose-driven " + index + ": " + shape.measure,
                bone = rig.Bones[joint],
                bindRotation = rig.Joints[joint].parentFromJoint.rotation,
            };
        }

        /// <summary>The same person with one measure changed; the nearest possible one where no person has all
        /// of them.</summary>
        static AnthroBody TargetBody(AnthroBody body, AnthroPoseDrivenShape shape)
        {
            var latent = new double[AnthroModel.Default.LatentSize];
            body.Latent(latent);
            var request = new AnthroRequest { Sex = body.Sex, Seed = body.Seed, Latent = latent, Nearest = true };
            var measures = body.Measures();
            int first, second;
            AnthroMeasures.IndicesOf(shape.measure, out first, out second);
            for (var i = 0; i < measures.Length; i++)
            {
                var factor = i == first || i == second ? 1.0 + shape.relativeChange : 1.0;
                request.Set(AnthroMeasures.Names[i], factor * measures[i].obtained);
            }
            return AnthroModel.Default.Generate(request);
        }

        void LateUpdate()
        {
            Apply();
        }

        /// <summary>Sets the weights from the current pose. `LateUpdate` calls it every frame; it allocates no managed
        /// memory.</summary>
        public void Apply()
        {
            if (madeFor == null || !ReferenceEquals(madeFor, Character.Body))
            {
                return;
            }
            for (var i = 0; i < drivers.Count; i++)
            {
                var driver = drivers[i];
                var shape = driver.shape;
                var angle = DegreesBetween(driver.bindRotation, driver.bone.localRotation);
                var weight = (angle - shape.startDegrees) / (shape.endDegrees - shape.startDegrees);
                Character.SetBlendShapeWeight(driver.blendShape, 100f * Mathf.Clamp01(weight));
            }
        }

        /// <summary>The angle between two rotations; 0 where rounding hides it.</summary>
        static float DegreesBetween(Quaternion a, Quaternion b)
        {
            var dot = Math.Abs((double)a.x * b.x + (double)a.y * b.y + (double)a.z * b.z + (double)a.w * b.w);
            return dot > 1.0 - 1e-6 ? 0f : (float)(2.0 * Math.Acos(dot) * 180.0 / Math.PI);
        }
    }
}
