using System.Collections.Generic;
using Anthronet.Native;
using UnityEngine;

namespace Anthronet
{
    /// <summary>Which joint is which bone of Unity's humanoid.</summary>
    public static unsafe class AnthroHumanoid
    {
        /// <summary>A joint of the rig that is a bone of the humanoid.</summary>
        public struct Bone
        {
            /// <summary>Name in the rig, such as `upperarm_l`.</summary>
            public string joint;
            /// <summary>Name in Unity's `HumanTrait.BoneName`, such as `Left Thumb Proximal`.</summary>
            public string trait;
            /// <summary>Whether Unity requires it.</summary>
            public bool required;
        }

        static Bone[] bones;

        /// <summary>All of them.</summary>
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
        /// What `AvatarBuilder` needs: a T-pose, every bone, Unity's own limits of the muscles. Limits say what a muscle at
        /// −1 and 1 is, so with others every humanoid clip, all of which were made for Unity's, would move this character by
        /// other angles than everybody else; and our own clips are within the joints' limits before they come to Unity.
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
                skeleton[i + 1].position = rig.Joints[i].local.translation;
                skeleton[i + 1].rotation = rig.Joints[i].local.rotation;
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

        /// <summary>The humanoid avatar of a rig below `root`, or null with an error in the console.</summary>
        public static Avatar Build(AnthroRig rig, GameObject root)
        {
            var avatar = AvatarBuilder.BuildHumanAvatar(root, Describe(rig, root.transform));
            if (avatar != null && avatar.isValid && avatar.isHuman)
            {
                avatar.name = root.name;
                return avatar;
            }
            Debug.LogError("AnthroNet: Unity made no humanoid avatar of " + root.name
                + ": no object in it may be called as a joint, such as `pelvis`", root);
            return null;
        }
    }
}
