using System.Collections.Generic;
using Anthronet.Native;
using UnityEngine;

namespace Anthronet
{
    /// <summary>Maps joints of the rig to bones of Unity's humanoid.</summary>
    public static unsafe class AnthroHumanoid
    {
        /// <summary>A humanoid bone and its joint.</summary>
        public struct Bone
        {
            /// <summary>Joint name in the rig, such as `upperarm_l`.</summary>
            public string joint;
            /// <summary>Name in Unity's `HumanTrait.BoneName`, such as `Left Thumb Proximal`.</summary>
            public string trait;
            /// <summary>Whether Unity requires it.</summary>
            public bool required;
        }

        static Bone[] bones;

        /// <summary>All mapped bones.</summary>
        public static IReadOnlyList<Bone> Bones
        {
            get { return bones ?? (bones = Read()); }
        }

        static Bone[] Read()
        {
            Library.Ensure();
            var read = new Bone[NativeMethods.anthronet_humanoid_bone_count()];
            for (var i = 0u; i < read.Length; i++)
            {
                var bone = new anthronet_humanoid_bone();
                bone.struct_size = (uint)sizeof(anthronet_humanoid_bone);
                anthronet_error error;
                Library.Check(NativeMethods.anthronet_humanoid_bone_at(i, &bone, &error), &error);
                read[i].joint = Utf8.Text(bone.native);
                read[i].trait = Utf8.Text(bone.unity_trait);
                read[i].required = bone.required != 0;
            }
            return read;
        }

        /// <summary>
        /// The description for `AvatarBuilder`: T-pose, every bone, Unity's default muscle limits. Muscle values are
        /// relative to the limits: with custom limits, humanoid clips authored for the default ones would rotate joints
        /// by other angles than on other characters. AnthroNet clips are within anatomical limits before they reach
        /// Unity.
        /// </summary>
        public static HumanDescription Describe(AnthroRig rig, Transform root)
        {
            var skeleton = new SkeletonBone[rig.Bones.Length + 1];
            skeleton[0].name = root.name;
            skeleton[0].rotation = Quaternion.identity;
            skeleton[0].scale = Vector3.one;
            for (var i = 0; i < rig.Bones.Length; i++)
            {
                skeleton[i + 1].name = rig.Bones[i].name;
                skeleton[i + 1].position = rig.Joints[i].parentFromJoint.translation;
                skeleton[i + 1].rotation = rig.Joints[i].parentFromJoint.rotation;
                skeleton[i + 1].scale = Vector3.one;
            }
            var human = new HumanBone[Bones.Count];
            for (var i = 0; i < human.Length; i++)
            {
                human[i].boneName = Bones[i].joint;
                human[i].humanName = Bones[i].trait;
                human[i].limit.useDefaultValues = true;
            }
            var description = new HumanDescription();
            description.skeleton = skeleton;
            description.human = human;
            description.upperArmTwist = 0.5f;
            description.lowerArmTwist = 0.5f;
            description.upperLegTwist = 0.5f;
            description.lowerLegTwist = 0.5f;
            description.armStretch = 0.05f;
            description.legStretch = 0.05f;
            description.feetSpacing = 0f;
            description.hasTranslationDoF = false;
            return description;
        }

        /// <summary>Builds the humanoid avatar of a rig below `root`; returns null and logs an error if Unity refuses
        /// it.</summary>
        public static Avatar Build(AnthroRig rig, GameObject root)
        {
            var avatar = AvatarBuilder.BuildHumanAvatar(root, Describe(rig, root.transform));
            if (avatar != null && avatar.isValid && avatar.isHuman)
            {
                avatar.name = root.name;
                return avatar;
            }
            Debug.LogError("AnthroNet: Unity could not build a humanoid avatar for " + root.name
                + ": no other object below it may have the name of a joint, such as `pelvis`", root);
            return null;
        }
    }
}
