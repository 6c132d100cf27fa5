using System;
using System.Collections.Generic;
using UnityEngine;

namespace Anthronet
{
    /// <summary>A corrective: a measure that grows, or shrinks, as a joint leaves its bind pose.</summary>
    [Serializable]
    public sealed class AnthroCorrective
    {
        /// <summary>The joint, by its name in the rig.</summary>
        public string joint = "lowerarm_l";

        /// <summary>Up to this angle from the bind pose nothing changes, degrees, not below 0.</summary>
        public float from = 15f;

        /// <summary>From this angle on the measure has changed whole, degrees, above `from`.</summary>
        public float to = 120f;

        /// <summary>The measure; a name without its side is both.</summary>
        public string measure = "arm_circumference_left";

        /// <summary>By how much of itself it changes, such as 0.05 for 5 %.</summary>
        public float change = 0.05f;
    }

    /// <summary>
    /// Correctives of poses: muscles that swell where a joint bends. Each is a blend shape that leads to the same person with
    /// one measure changed, and its weight is set every frame by how far the joint has turned; in the bind pose it is
    /// exactly 0. The shapes are made when the character is generated, some 10 ms each. It begins with upper arms that
    /// swell by 5 % as elbows bend: a cautious number that nobody measured.
    /// </summary>
    [AddComponentMenu("AnthroNet/AnthroNet Correctives")]
    [RequireComponent(typeof(AnthroCharacter))]
    [DisallowMultipleComponent]
    // After the animators, which pose in their own `LateUpdate`.
    [DefaultExecutionOrder(100)]
    public sealed class AnthroCorrectives : MonoBehaviour
    {
        [SerializeField] List<AnthroCorrective> correctives = new List<AnthroCorrective>
        {
            new AnthroCorrective(),
            new AnthroCorrective { joint = "lowerarm_r", measure = "arm_circumference_right" },
        };

        struct Driver
        {
            public AnthroCorrective corrective;
            public string shape;
            public Transform bone;
            public Quaternion bind;
        }

        readonly List<Driver> drivers = new List<Driver>();
        AnthroCharacter character;
        AnthroBody madeFor;

        /// <summary>The correctives; `Rebuild` makes changes of them be seen.</summary>
        public List<AnthroCorrective> Correctives
        {
            get { return correctives; }
        }

        AnthroCharacter Character()
        {
            if (character == null)
            {
                character = GetComponent<AnthroCharacter>();
            }
            return character;
        }

        void OnEnable()
        {
            Character().OnReport += Made;
            if (Character().Body != null && !ReferenceEquals(Character().Body, madeFor))
            {
                Made(Character().Body);
            }
        }

        void OnDisable()
        {
            if (Character() != null)
            {
                Character().OnReport -= Made;
            }
        }

        // What fails here nobody could catch, and the character is as good without.
        void Made(AnthroBody body)
        {
            try
            {
                Rebuild();
            }
            catch (Exception error)
            {
                Debug.LogException(error, this);
            }
        }

        /// <summary>Makes the shapes for the body that the character is, in place of all blend shapes that it had.</summary>
        /// <exception cref="AnthroException">There is no measure of that name.</exception>
        /// <exception cref="ArgumentException">There is no joint of that name, or the angles are not in order.</exception>
        public void Rebuild()
        {
            var body = Character().Body;
            if (body == null)
            {
                throw new InvalidOperationException(
                    "the character has to be generated before it gets correctives: " + gameObject.name);
            }
            var next = new List<Driver>();
            foreach (var corrective in correctives)
            {
                next.Add(DriverOf(corrective, character.Rig, next.Count));
            }
            drivers.Clear();
            madeFor = null;
            character.ClearBlendShapes();
            foreach (var driver in next)
            {
                using (var changed = Changed(body, driver.corrective))
                {
                    character.AddBlendShape(driver.shape, changed);
                }
            }
            drivers.AddRange(next);
            madeFor = body;
            Apply();
        }

        static Driver DriverOf(AnthroCorrective corrective, AnthroRig rig, int place)
        {
            var joint = Array.FindIndex(rig.Bones, bone => bone.name == corrective.joint);
            if (joint < 0)
            {
                throw new ArgumentException("corrective " + place + ": there is no joint \"" + corrective.joint + "\"", "joint");
            }
            if (!(corrective.from >= 0f && corrective.to > corrective.from))
            {
                throw new ArgumentException("corrective " + place + ": expected degrees with 0 <= from < to, got "
                    + corrective.from + " and " + corrective.to, "from");
            }
            // Says which measure there is not before any shape is taken off.
            int first, second;
            AnthroMeasures.Sides(corrective.measure, out first, out second);
            return new Driver
            {
                corrective = corrective,
                shape = "corrective " + place + ": " + corrective.measure,
                bone = rig.Bones[joint],
                bind = rig.Joints[joint].local.rotation,
            };
        }

        /// <summary>The same person with one measure changed; as near as people come where nobody has all 36.</summary>
        static AnthroBody Changed(AnthroBody body, AnthroCorrective corrective)
        {
            var latent = new double[AnthroModel.Default.LatentSize];
            body.Latent(latent);
            var request = new AnthroRequest { Sex = body.Sex, Seed = body.Seed, Latent = latent, Nearest = true };
            var measures = body.Measures();
            int first, second;
            AnthroMeasures.Sides(corrective.measure, out first, out second);
            for (var i = 0; i < measures.Length; i++)
            {
                var grown = i == first || i == second ? 1.0 + corrective.change : 1.0;
                request.Set(AnthroMeasures.Names[i], grown * measures[i].obtained);
            }
            return AnthroModel.Default.Generate(request);
        }

        void LateUpdate()
        {
            Apply();
        }

        /// <summary>Sets the weights by the pose that the joints have. `LateUpdate` does it each frame; makes no garbage.
        /// </summary>
        public void Apply()
        {
            if (madeFor == null || !ReferenceEquals(madeFor, Character().Body))
            {
                return;
            }
            for (var i = 0; i < drivers.Count; i++)
            {
                var driver = drivers[i];
                var angle = Degrees(driver.bind, driver.bone.localRotation);
                var share = (angle - driver.corrective.from) / (driver.corrective.to - driver.corrective.from);
                character.SetBlendShapeWeight(driver.shape, 100f * Mathf.Clamp01(share));
            }
        }

        /// <summary>The angle between two rotations; 0 where it is lost in rounding.</summary>
        static float Degrees(Quaternion a, Quaternion b)
        {
            var dot = Math.Abs((double)a.x * b.x + (double)a.y * b.y + (double)a.z * b.z + (double)a.w * b.w);
            return dot > 1.0 - 1e-6 ? 0f : (float)(2.0 * Math.Acos(dot) * 180.0 / Math.PI);
        }
    }
}
